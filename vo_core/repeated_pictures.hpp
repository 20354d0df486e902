#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// Notices pictures that come again while the cart moves: of a camera that hangs and goes on sending, or of
/// one that fills gaps. They would be taken for a sudden stop, byte for byte as they are. A cart that has
/// stopped looks so too, if an encoder leaves out its noise; but it cannot have stopped from one pair to the
/// next. What is slower than that, a method has to find out by itself.
class RepeatedPictures {
 public:
  /// Whether the pair tells nothing, as either picture is the one before, and was that already while the cart
  /// was too fast to stop. `last`: what is known of the pair before.
  bool repeat(const StereoImages& images, const OdometryEstimate& last);

 private:
  /// Of one camera.
  struct Picture {
    /// Takes the next one in, of which some rows are looked at; whether it is the one before.
    bool next(const cv::Mat& image);

    std::vector<std::uint8_t> rows;
    bool repeats = false;
  };

  std::array<Picture, 2> pictures_;  ///< left and right
};

}  // namespace cartvo
