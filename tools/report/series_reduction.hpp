#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// The parts of a curve between points that are not finite, px. Of points within the same half px of x, which
/// follow each other, the first, lowest, highest and last remain.
std::vector<std::vector<cv::Point2d>> visibleParts(const std::vector<cv::Point2d>& pixels);

}  // namespace cartvo
