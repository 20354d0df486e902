#pragma once

#include <Eigen/Core>
#include <optional>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// The crossing of two black and two white squares about `start`, to a fraction of a pixel, from the grey
/// image's gradients (W. Foerstner and E. Guelch, 1987, as cv::cornerSubPix). `room`: how far around nothing
/// else is printed, px. Nothing if there is no crossing within reach.
std::optional<Eigen::Vector2d> refinedCorner(const cv::Mat& grey, const Eigen::Vector2d& start, double room);

}  // namespace cartvo
