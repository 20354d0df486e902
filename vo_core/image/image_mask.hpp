#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core/mat.hpp>

#include "vo_core/odometry_settings.hpp"

namespace cartvo::vo {

/// Where patches may be taken from an image of which some pixels must not be used: a patch must not contain
/// any of them. By default, and with an empty mask, everywhere. Copies share the pixels.
class ImageMask {
 public:
  ImageMask() = default;
  /// `used`: CV_8UC1 of the image's size, 0 where the image must not be used; may be empty.
  explicit ImageMask(const cv::Mat& used);

  bool empty() const { return clear_.front().empty(); }

  /// Whether the patch of a landmark of this pyramid level, centred at `pixel` (px of the full image), is
  /// free of masked pixels.
  bool allows(const Eigen::Vector2d& pixel, int level) const {
    const cv::Mat& clear = clear_[static_cast<std::size_t>(level)];
    if (clear.empty()) return true;
    const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, clear.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, clear.rows - 1);
    return *clear.ptr(y, x) != 0;
  }

 private:
  /// For each landmark level, 0 at the centres of patches that contain a masked pixel; CV_8UC1 of the size of
  /// the full image.
  std::array<cv::Mat, kLandmarkLevels> clear_;
};

}  // namespace cartvo::vo
