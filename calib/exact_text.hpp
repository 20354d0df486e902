#pragma once

#include <string>
#include <vector>

namespace cartvo {

/// A number with as few digits as give the same double back.
std::string exactText(double value);

/// Numbers as YAML and JSON list them: [1, 2.5].
std::string exactText(const std::vector<double>& values);

}  // namespace cartvo
