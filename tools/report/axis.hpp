#pragma once

#include <string>

namespace cartvo {

/// Step of 1, 2 or 5 times a power of ten that divides `range` into at most `parts` parts.
double roundStep(double range, int parts);

/// A multiple of `step` as text, with the decimals that the step needs.
std::string tickLabel(double value, double step);

}  // namespace cartvo
