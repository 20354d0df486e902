#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

namespace cartvo::calib {

/// A downscaled copy of a large image, to speed up the search for boards. The corners found are refined in
/// the full image.
struct SearchImage {
  cv::Mat image;
  double scale = 1.0;  ///< px of the full image per px of this one

  /// Scales the image down to at most `max_side` px in width and height.
  SearchImage(const cv::Mat& full, double max_side) {
    scale = std::max(1.0, std::max(full.cols, full.rows) / max_side);
    image = full;
    if (scale > 1.0) cv::resize(full, image, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
  }

  /// The position of a point in the full image; pixel centres at integers in both.
  Eigen::Vector2d toFullImage(const cv::Point2f& point) const {
    return {(point.x + 0.5) * scale - 0.5, (point.y + 0.5) * scale - 0.5};
  }
};

/// Locates the crossing of two black and two white squares near `start` with subpixel accuracy, from the
/// gradients of the grey image (W. Foerstner and E. Guelch, 1987, as cv::cornerSubPix). `room`: radius around
/// the corner without other printed features, px. std::nullopt if there is no crossing nearby.
std::optional<Eigen::Vector2d> refineCorner(const cv::Mat& grey, const Eigen::Vector2d& start, double room);

}  // namespace cartvo::calib
