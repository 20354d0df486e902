#pragma once

#include <optional>

#include "tools/videos/image_motion.hpp"

namespace cartvo {

/// Relation of the file times of two videos: left time = offset + (1 + skew) * right time.
struct PictureOffset {
  double offset = 0.0;  ///< s
  std::optional<double>
      skew;                ///< of the right file's clock; empty if the videos are too short to estimate it
  double stddev = 0.0;     ///< s, of the left time, over the common duration
  double agreement = 0.0;  ///< correlation of the two image motions; 1: equal
};

/// Estimates the relation from image motion: turns and bumps move both images alike. First correlates the
/// motions over all shifts with an overlap of at least 5 s and a third of the shorter video. Then, in
/// segments of 20 s, fits the right motion by the interpolated left one. The segments give the skew, if they
/// span a minute, and their scatter gives the standard deviation. Throws std::runtime_error if the result is
/// not unique: no motion, or another shift fits as well.
PictureOffset findPictureOffset(const ImageMotion& left, const ImageMotion& right);

}  // namespace cartvo
