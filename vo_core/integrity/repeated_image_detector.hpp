#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vo_core/odometry_estimate.hpp"
#include "vo_core/stereo_masks.hpp"

namespace cartvo::vo {

/// Which images of a pair equal those of the previous pair byte for byte, apart from what is masked.
struct ImageRepeats {
  bool left = false, right = false;
  bool while_moving = false;  ///< one of them has repeated since the cart was too fast to stop
};

/// Detects images that repeat while the cart moves: from a frozen camera that continues to send, or from one
/// that fills gaps. Without it they would look like a sudden stop. The images of a stopped cart repeat too if
/// the encoder suppresses noise, but a cart at speed cannot stop from one pair to the next. At speeds from
/// which it can, the estimator has to detect a frozen camera itself. Masked pixels are not compared: a clock
/// that the camera writes into its images goes on when the images are frozen.
class RepeatedImageDetector {
 public:
  /// Keeps headers of the masks: their pixels must not change.
  explicit RepeatedImageDetector(const StereoMasks& masks = {}) : cameras_{{{masks.left}, {masks.right}}} {}

  /// Compares the next pair with the previous one. `last`: estimate of the previous pair.
  ImageRepeats update(const StereoImages& images, const OdometryEstimate& last);

 private:
  /// State of one camera.
  struct Camera {
    /// Stores sampled rows of the next image; returns whether they equal those of the previous one.
    bool repeats(const cv::Mat& image);
    /// Row `y` of the image, with zeros where it is masked.
    const std::uint8_t* unmasked(const cv::Mat& image, int y);

    cv::Mat mask;  ///< as StereoMasks'
    std::vector<std::uint8_t> rows = {};
    std::vector<std::uint8_t> row = {};  ///< reused by unmasked
    bool frozen = false;                 ///< the image has repeated since the cart was too fast to stop
  };

  std::array<Camera, 2> cameras_;  ///< left and right
};

}  // namespace cartvo::vo
