#pragma once

#include <Eigen/Core>
#include <optional>

#include <opencv2/core/mat.hpp>

namespace cartvo::calib {

/// Locates the crossing of two black and two white squares near `start` with subpixel accuracy, from the
/// gradients of the grey image (W. Foerstner and E. Guelch, 1987, as cv::cornerSubPix). `room`: radius around
/// the corner without other printed features, px. std::nullopt if there is no crossing nearby.
std::optional<Eigen::Vector2d> refineCorner(const cv::Mat& grey, const Eigen::Vector2d& start, double room);

}  // namespace cartvo::calib
