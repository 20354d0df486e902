#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// Which of a pair's pictures are those of the pair before, to the byte.
struct PictureRepeats {
  bool left = false, right = false;
  bool of_moving_cart = false;  ///< one of them is, and was that already while the cart was too fast to stop
};

/// Notices pictures that come again while the cart moves: of a camera that hangs and goes on sending, or of
/// one that fills gaps. They would be taken for a sudden stop, byte for byte as they are. A cart that has
/// stopped looks so too, if an encoder leaves out its noise; but it cannot have stopped from one pair to the
/// next. What is slower than that, a method has to find out by itself.
class RepeatedPictures {
 public:
  /// Takes the next pair in. `last`: what is known of the one before.
  PictureRepeats take(const StereoImages& images, const OdometryEstimate& last);

 private:
  /// Of one camera.
  struct Picture {
    /// Takes the next one in, of which some rows are looked at; whether it is the one before.
    bool next(const cv::Mat& image);

    std::vector<std::uint8_t> rows;
    bool hangs = false;  ///< it has been the same since the cart was too fast to stop
  };

  std::array<Picture, 2> pictures_;  ///< left and right
};

}  // namespace cartvo
