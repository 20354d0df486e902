#pragma once

#include <string>
#include <vector>

// Numbers as text, whatever the locale of the program: with a dot, without grouping.

namespace cartvo {

/// A number with as few digits (6 to 17) as read back to the same double.
std::string exactText(double value);

/// Numbers as a sequence in YAML and JSON: [1, 2.5].
std::string exactText(const std::vector<double>& values);

/// A number rounded to so many decimals, as by printf's "%.3f".
std::string fixedText(double value, int decimals);

/// A number rounded to so many significant digits, as by printf's "%.6g".
std::string roundedText(double value, int digits = 6);

}  // namespace cartvo
