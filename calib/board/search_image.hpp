#pragma once

#include <Eigen/Core>
#include <algorithm>

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

}  // namespace cartvo::calib
