#pragma once

#include "tools/videos/image_motion.hpp"

namespace cartvo {

/// How the times of two videos belong together: left time = offset + (1 + skew) * right time.
struct PictureOffset {
  double offset = 0.0;     ///< s
  double skew = 0.0;       ///< of the right file's clock; 0 where the videos are too short to tell
  double deviation = 0.0;  ///< standard deviation of the sum, over the time that both cover, s
  double agreement = 0.0;  ///< correlation of the two motions, 1: the same
};

/// From what both cameras saw: turning and bumps move both images alike. First the correlation of the two
/// motions over all shifts by which the videos still overlap by a third of the shorter one (and 5 s), then,
/// in parts of 20 s, the shift that explains the right motion best by the left one between its pictures. The
/// parts tell the skew, if there are a minute of them, and by their scatter how well all is known. Throws
/// std::runtime_error if the motions do not tell it: no motion, or another shift would do as well.
PictureOffset findOffset(const ImageMotion& left, const ImageMotion& right);

}  // namespace cartvo
