#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording_folder.hpp"

namespace cartvo {

/// What the index says of one camera's pictures.
struct RecordedCamera {
  std::optional<VideoCodec> codec;  ///< of the first picture; nothing if none can be read
  cv::Size picture_size;            ///< px, likewise
  std::uint64_t pictures = 0;
  std::uint64_t key_pictures = 0;
  std::uint64_t damaged = 0;      ///< marked so when they were received
  std::uint64_t missed = 0;       ///< between the first and the last, by their numbers
  std::uint64_t connections = 0;  ///< that pictures came from
  std::uint64_t bytes = 0;        ///< as received
  std::int64_t first_arrival_ns = 0;
  std::int64_t last_arrival_ns = 0;
  std::array<std::uint64_t, 5> by_instant_source{};  ///< pictures, by InstantSource

  double seconds() const { return 1e-9 * static_cast<double>(last_arrival_ns - first_arrival_ns); }
};

/// One camera's part of a segment that was not ended: whoever wrote it was cut off. Up to its last picture,
/// and perhaps beyond, all is there.
struct UnendedPart {
  CameraSide side = CameraSide::left;
  std::uint64_t segment = 0;
  std::optional<std::int64_t> last_arrival_ns;  ///< of its last picture in the index; nothing if it has none
};

/// What a recording holds, by its description and indices; nothing is decoded.
struct RecordingSummary {
  RecordingInfo info;
  std::uint64_t segments = 0;
  std::uint64_t bytes = 0;  ///< of all files
  bool being_written = false;
  std::array<RecordedCamera, 2> cameras;  ///< left, right
  std::vector<UnendedPart> unended;       ///< but for what is being written
};

/// Throws what readRecordingInfo throws.
RecordingSummary summariseRecording(const std::filesystem::path& folder);

}  // namespace cartvo
