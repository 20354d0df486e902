#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "calib/model/rig.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo {

/// Two video files, one for each camera, from any recorder.
struct VideoPair {
  std::filesystem::path left;
  std::filesystem::path right;
};

/// Relation between the two videos' timestamps: left time = offset + (1 + skew) * right time.
struct VideoTiming {
  double offset = 0.0;  ///< s
  double skew = 0.0;    ///< of the right video's clock
  double stddev = 0.0;  ///< of the left time computed from a right time, s
  std::string found_by = "given";
  std::optional<double> agreement;  ///< of the two image motions, if the offset was estimated from the images
};

/// A part of the left video, s in its timestamps.
struct VideoPart {
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// Opens the two videos as a source. Exposures are their timestamps, relative to the left video's creation
/// time (to 1970 if it has none). Throws what VideoFileSource throws.
capture::StereoSource openVideos(const VideoPair& videos, const VideoTiming& timing, const VideoPart& part);

/// Progress: number of pictures of both videos that have been read, and their total number (0: unknown).
using VideoProgress = std::function<void(std::size_t pictures, std::size_t expected)>;

/// Estimates the timing from the images: first from the image motion of both videos (findPictureOffset), then
/// refined with the odometry's time offset over the part with the most motion, iterated until the remaining
/// offset is insignificant. Throws what findPictureOffset and VideoFileSource throw.
VideoTiming findVideoTiming(const VideoPair& videos, const calib::Rig& rig, const VideoProgress& progress);

}  // namespace cartvo
