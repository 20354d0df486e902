#pragma once

#include <string>
#include <vector>

namespace cartvo {

/// Step of 1, 2 or 5 times a power of ten that divides `range` into at most `parts` parts.
double roundStep(double range, int parts);

/// The multiples of `step` from `low` to `high`.
std::vector<double> multiplesOf(double step, double low, double high);

/// A multiple of `step` as text, with the decimals that the step needs.
std::string tickLabel(double value, double step);

}  // namespace cartvo
