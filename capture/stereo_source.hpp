#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_source.hpp"
#include "capture/dataset/image_folder.hpp"
#include "capture/recording/recording_source.hpp"

// Opening of recordings, data sets and videos as a pair of frame sources.

namespace cartvo::capture {

/// Kind of a stereo source on disk.
enum class SourceKind : std::uint8_t { recording, kitti, kitti_raw, euroc, lists, one_folder, videos };

/// Two cameras on disk, with the files that describe their rig. Fields that do not apply are empty.
struct StereoSource {
  SourceKind kind = SourceKind::kitti;
  std::unique_ptr<CameraSource> left;
  std::unique_ptr<CameraSource> right;
  std::int64_t period_ns = 0;             ///< nominal frame period; 0: unknown, to be estimated
  std::size_t pairs = 0;                  ///< number of images of the shorter sequence; 0: unknown
  std::filesystem::path first_image;      ///< the left camera's; empty for other sources than image folders
  PicturePart part = PicturePart::whole;  ///< of it that is the left camera's
  std::vector<std::string> warnings;      ///< see ImageFolder::warnings
  std::filesystem::path calib_file;       ///< as in ImageFolder, as are the following
  std::array<int, 2> cameras{0, 1};
  std::filesystem::path rig_file;
  std::array<std::filesystem::path, 2> sensor_files;
  std::shared_ptr<RecordingTimestamper> clock;  ///< recomputes a recording's time stamps; null: recorded ones
  std::string rig_text;                         ///< text of the rig file stored in a recording
};

/// Detects the kind of `path` and opens it. Throws std::runtime_error that lists the supported kinds if it is
/// none of them, or that describes what is wrong with it.
StereoSource openSource(const std::filesystem::path& path);

/// Settings for opening a source.
struct SourceSettings {
  /// Standard deviation of the time offsets of an image folder's pairs, ns. Recordings contain their own.
  double folder_offset_stddev_ns = 0.0;

  /// See ImageFolderSettings::frame_rate. 0 is required for recordings.
  double frame_rate = 0.0;
  bool side_by_side = false;  ///< see ImageFolderSettings; not for recordings

  /// Clock choice by which a recording's time stamps are recomputed from its RTP times, sender reports and
  /// arrivals; nothing: the recorded instants are used.
  std::optional<ClockChoice> clock;
};
StereoSource openSource(const std::filesystem::path& path, const SourceSettings& settings);

}  // namespace cartvo::capture
