#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "capture/camera_source.hpp"
#include "capture/image_folder.hpp"
#include "capture/recording_clock.hpp"

namespace cartvo {

enum class SourceKind : std::uint8_t { recording, kitti, euroc, videos };

/// Two cameras on disk, with what lies beside them that tells of the rig. Fields that do not apply are empty.
struct StereoSource {
  SourceKind kind = SourceKind::kitti;
  std::unique_ptr<CameraSource> left;
  std::unique_ptr<CameraSource> right;
  std::int64_t period_ns = 0;  ///< nominal time between a camera's frames; 0: unknown, to be learned
  std::size_t pairs = 0;       ///< images of the shorter side; 0: unknown
  std::optional<RectifiedStereo> rectified;  ///< the images are rectified already (KITTI's calib.txt)
  std::filesystem::path calib_file;          ///< KITTI's calib.txt
  std::filesystem::path rig_file;            ///< rig.yaml in the folder
  std::array<std::filesystem::path, 2> sensor_files;  ///< EuRoC's sensor.yaml, left and right
  std::shared_ptr<RecordingClock> clock;  ///< stamps a recording anew; null: it is as it was stamped live
  std::string rig_text;                   ///< a recording's rig file, as it was handed to the recorder
  std::string configuration_text;         ///< a recording's configuration
};

/// Finds out what `path` is and opens it. Throws std::runtime_error that lists what was looked for if it is
/// none of the kinds, or that says what is wrong with it.
StereoSource openSource(const std::filesystem::path& path);

struct SourceSettings {
  /// Standard deviation of the offsets of an image folder's pairs, ns. A recording knows its own.
  double folder_offset_deviation_ns = 0.0;

  /// A recording is stamped anew by this choice, as live: from its RTP times, sender reports and arrivals;
  /// nothing: the instants are those that were recorded.
  std::optional<ClockChoice> clock;

  /// Of a recording, see StereoSource::period_ns.
  std::int64_t recording_period_ns = 0;
};
StereoSource openSource(const std::filesystem::path& path, const SourceSettings& settings);

}  // namespace cartvo
