#pragma once

#include <string>
#include <vector>

namespace cartvo {

/// A number with as few digits (6 to 17) as read back to the same double.
std::string exactText(double value);

/// Numbers as a sequence in YAML and JSON: [1, 2.5].
std::string exactText(const std::vector<double>& values);

}  // namespace cartvo
