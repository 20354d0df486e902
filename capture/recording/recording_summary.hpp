#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording/recording_folder.hpp"

// Statistics of a recording, without decoding it.

namespace cartvo::capture {

/// Statistics of one camera's pictures, from the index.
struct RecordedCamera {
  std::optional<VideoCodec> codec;  ///< of the first picture; nothing if no picture can be read
  cv::Size picture_size;            ///< of the first picture, px
  std::uint64_t pictures = 0;
  std::uint64_t key_pictures = 0;
  std::uint64_t damaged = 0;      ///< marked as damaged on reception
  std::uint64_t missed = 0;       ///< not received, by the gaps of the sequence numbers
  std::uint64_t connections = 0;  ///< number of connections with pictures
  std::uint64_t bytes = 0;        ///< as received
  std::int64_t first_arrival_ns = 0;
  std::int64_t last_arrival_ns = 0;
  std::array<std::uint64_t, 5> by_instant_source{};  ///< pictures, by InstantSource

  double seconds() const { return 1e-9 * static_cast<double>(last_arrival_ns - first_arrival_ns); }
};

/// One camera's part of a segment that was not finalised, because its writer was interrupted. It is complete
/// up to its last picture in the index.
struct UnfinalisedPart {
  CameraSide side = CameraSide::left;
  std::uint64_t segment = 0;
  std::optional<std::int64_t>
      last_arrival_ns;  ///< of the last picture in the index; nothing if there is none
};

/// Content of a recording, from its description and indices; nothing is decoded.
struct RecordingSummary {
  RecordingInfo info;
  std::uint64_t segments = 0;
  std::uint64_t bytes = 0;  ///< of all files
  bool being_written = false;
  std::array<RecordedCamera, 2> cameras;     ///< left, right
  std::vector<UnfinalisedPart> unfinalised;  ///< except parts that are being written
};

/// Throws the errors of readRecordingInfo.
RecordingSummary summariseRecording(const std::filesystem::path& folder);

/// Whether the Matroska file was finalised by its writer: only then does its header contain the segment's
/// size (RFC 9559, "Unknown-Sized Elements"). False if the file is not Matroska or does not exist.
bool isMatroskaFinalised(const std::filesystem::path& matroska_file);

}  // namespace cartvo::capture
