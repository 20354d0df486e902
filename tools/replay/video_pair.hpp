#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "calib/model/rig.hpp"
#include "capture/dataset/video_file_source.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo {

/// Two video files, one for each camera, or one file with the pictures of both, from any recorder.
struct VideoPair {
  std::filesystem::path left;
  std::filesystem::path right;  ///< equal to `left` if both cameras are in one file
  double frame_rate = 0.0;      ///< Hz, see VideoFileTime
  capture::VideoView left_view{}, right_view{};
  bool is_one_file = false;
};

/// The videos of a rig. An empty `right` means that `left` contains both pictures, side by side (left camera
/// on the left) or one above the other (left camera above). Throws std::runtime_error naming the sizes if the
/// pictures are not the rig's, and what VideoFileSource throws.
VideoPair findVideos(const std::filesystem::path& left, const std::filesystem::path& right, double frame_rate,
                     const calib::Rig& rig);

/// Relation between the two videos' timestamps: left time = offset + (1 + skew) * right time.
struct VideoTiming {
  double offset = 0.0;         ///< s
  std::optional<double> skew;  ///< of the right video's clock; empty: not known, counts as 0
  double stddev = 0.0;         ///< of the left time computed from a right time, s
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
