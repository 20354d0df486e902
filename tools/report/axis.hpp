#pragma once

#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// Step of 1, 2 or 5 times a power of ten that divides `range` into at most `parts` parts.
double roundStep(double range, int parts);

/// A multiple of `step` as text, with the decimals that the step needs.
std::string tickLabel(double value, double step);

/// The parts of a curve between points that are not finite, px. Of points within the same half px of x, which
/// follow each other, the first, lowest, highest and last remain.
std::vector<std::vector<cv::Point2d>> visibleParts(const std::vector<cv::Point2d>& pixels);

}  // namespace cartvo
