#pragma once

#include <Eigen/Core>
#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace cartvo {

/// An image in which boards are searched: made smaller where it is large, since that only takes longer; the
/// corners found are refined in the whole one.
struct SearchImage {
  cv::Mat image;
  double scale = 1.0;  ///< px of the whole image in one of this

  /// At most `largest_side` px wide and high.
  SearchImage(const cv::Mat& whole, double largest_side) {
    scale = std::max(1.0, std::max(whole.cols, whole.rows) / largest_side);
    image = whole;
    if (scale > 1.0) cv::resize(whole, image, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
  }

  /// Where a point lies in the whole image; pixel centres at integers in both.
  Eigen::Vector2d inWhole(const cv::Point2f& point) const {
    return {(point.x + 0.5) * scale - 0.5, (point.y + 0.5) * scale - 0.5};
  }
};

}  // namespace cartvo
