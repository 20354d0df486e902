#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "tests/support/capture/encoded_sequence.hpp"

namespace cartvo::test {

// Pictures to record, and access to what was recorded.

/// Default settings of a recording in that folder.
inline capture::RecordingSettings settingsFor(const std::filesystem::path& folder) {
  capture::RecordingSettings settings;
  settings.folder = folder;
  return settings;
}

/// Pictures of 2.25 s, a key picture every 0.75 s.
inline const std::vector<capture::EncodedUnit>& camera() {
  static const std::vector<capture::EncodedUnit> units =
      encodeSequence(capture::VideoCodec::h264, cv::Size(320, 200), 45, 15, "");
  return units;
}

/// The picture at an index of their endless repetition, in the order of time.
inline capture::EncodedUnit unitAt(int index) {
  const auto count = static_cast<int>(camera().size());
  capture::EncodedUnit unit = camera()[static_cast<std::size_t>(index % count)];
  const std::int64_t later_ns = index / count * std::int64_t{2'250'000'000};
  unit.exposure_ns += later_ns;
  unit.arrival_ns += later_ns;
  unit.sequence = static_cast<std::uint64_t>(index);
  return unit;
}

/// Sequence numbers of a camera's pictures in a recording.
inline std::vector<std::uint64_t> recordedSequences(const std::filesystem::path& folder,
                                                    capture::CameraSide side) {
  capture::RecordingReader reader(folder, side);
  std::vector<std::uint64_t> sequences;
  for (capture::RecordedUnit recorded; reader.next(recorded);)
    sequences.push_back(recorded.unit.sequence);
  return sequences;
}

/// Numbers of the existing segments; empty if there is no recording.
inline std::vector<std::uint64_t> segmentNumbers(const std::filesystem::path& recording) {
  std::vector<std::uint64_t> numbers;
  if (!std::filesystem::exists(recording)) return numbers;
  for (const capture::RecordingSegment& segment : capture::recordingSegments(recording))
    numbers.push_back(segment.number);
  return numbers;
}

}  // namespace cartvo::test
