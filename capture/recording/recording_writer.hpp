#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording/recording_folder.hpp"

namespace cartvo::capture {

class StreamWriter;

/// Writes a recording, segment by segment. A segment begins with a key picture of either camera; the other
/// camera joins it with its own next key picture. Not thread-safe. All members throw std::runtime_error
/// naming the file if it cannot be written.
class RecordingWriter {
 public:
  /// Creates the folder if it does not exist, and locks recording.json (see isBeingWritten). Also throws if
  /// the folder already contains a recording.
  RecordingWriter(std::filesystem::path folder, const RecordingInfo& info,
                  std::chrono::nanoseconds segment_length);
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Begins a connection of the camera: units of this format follow.
  void beginConnection(CameraSide side, const StreamFormat& format);

  /// Writes a unit and assigns its `order`. Returns false if it was not written, because no key picture came
  /// before it.
  bool write(CameraSide side, EncodedUnit unit);

  /// Writes everything to the disk, so that it survives a power cut.
  void sync();

  /// Finalises the files as far as the disk permits; the next key picture begins a new segment.
  void endSegment() noexcept;

  const std::filesystem::path& folder() const { return folder_; }

  /// The first segment that is still being written, or the last finalised one; earlier segments do not change
  /// any more.
  std::uint64_t oldestOpenSegment() const;

 private:
  struct Side {
    std::optional<StreamFormat> format;
    std::uint64_t connection = 0;
    std::unique_ptr<StreamWriter> writer;
    std::uint64_t segment = 0;  ///< of the writer
  };

  bool beginsNewSegment(const Side& side, const EncodedUnit& unit) const;
  void openSegmentFor(CameraSide which, const EncodedUnit& unit);

  std::filesystem::path folder_;
  std::chrono::nanoseconds segment_length_;
  int lock_ = -1;  ///< descriptor of recording.json
  std::array<Side, 2> sides_;
  std::uint64_t segment_ = 0;             ///< number of the latest segment
  std::optional<std::int64_t> began_ns_;  ///< start of that segment; nothing before the first one
  std::uint64_t order_ = 0;
};

/// Whether a RecordingWriter, of any process, is writing the recording.
bool isBeingWritten(const std::filesystem::path& recording);

}  // namespace cartvo::capture
