#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "calib/rig.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo {

/// A capture that others made: a video for each camera.
struct VideoPair {
  std::filesystem::path left;
  std::filesystem::path right;
};

/// How the two videos' time stamps belong together: left time = offset + (1 + skew) * right time.
struct VideoTiming {
  double offset = 0.0;     ///< s
  double skew = 0.0;       ///< of the right video's clock
  double deviation = 0.0;  ///< standard deviation of the sum, s
  std::string found_by = "given";
  std::optional<double> agreement;  ///< of the two image motions, where the pictures told the offset
};

/// A part of the left video, s by its time stamps.
struct VideoPart {
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// The two videos as a source: exposures are their time stamps, counted from when the left video says that it
/// was made (from 1970 if it does not say). Throws what VideoFileSource throws.
StereoSource openVideos(const VideoPair& videos, const VideoTiming& timing, const VideoPart& part);

/// Is told how many pictures of both videos have been looked at, and how many there are (0: unknown).
using VideoProgress = std::function<void(std::size_t pictures, std::size_t expected)>;

/// From the pictures: the image motion of both videos (findOffset), then, where the cart moves most, what the
/// odometry finds the right camera late by, put into the offset until nothing is left of it. Throws what
/// findOffset and VideoFileSource throw.
VideoTiming findVideoTiming(const VideoPair& videos, const Rig& rig, const VideoProgress& progress);

}  // namespace cartvo
