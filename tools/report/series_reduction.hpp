#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// The parts of a curve between points that are not finite, px. Of points within the same half px of x, which
/// follow each other, the first, lowest, highest and last remain.
std::vector<std::vector<cv::Point2d>> visibleParts(const std::vector<cv::Point2d>& pixels);

/// Outlines of the area between two curves with the same x, px: one for each part in which both are finite.
/// Of points within the same half px of x one pair remains, with the widest extent.
std::vector<std::vector<cv::Point2d>> visibleAreas(const std::vector<cv::Point2d>& low,
                                                   const std::vector<cv::Point2d>& high);

}  // namespace cartvo
