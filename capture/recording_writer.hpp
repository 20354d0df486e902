#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording_folder.hpp"

namespace cartvo {

class StreamWriter;

/// Writes a recording, segment by segment. A segment begins with a key picture of either camera; the other
/// one joins it with its own next key picture. One thread. All members throw std::runtime_error naming the
/// file when it cannot be written.
class RecordingWriter {
 public:
  /// Makes the folder, if it is not there, and holds recording.json locked (see isBeingWritten). Also throws
  /// if there is a recording in it already.
  RecordingWriter(std::filesystem::path folder, const RecordingInfo& info,
                  std::chrono::nanoseconds segment_length);
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// The camera opened a connection: units of this format follow.
  void begin(CameraSide side, const StreamFormat& format);

  /// Returns whether the unit was written: what comes before the first key picture is not. `order` of the
  /// unit is given here.
  bool write(CameraSide side, EncodedUnit unit);

  /// What was written survives a power cut once this returns.
  void sync();

  /// Ends the files, as well as the disk lets it; the next key picture begins a new segment.
  void endSegment() noexcept;

  const std::filesystem::path& folder() const { return folder_; }

  /// The first segment that is still written to, or the one that was ended last; what lies before it will not
  /// change.
  std::uint64_t oldestOpenSegment() const;

 private:
  struct Side {
    std::optional<StreamFormat> format;
    std::uint64_t connection = 0;
    std::unique_ptr<StreamWriter> writer;
    std::uint64_t segment = 0;  ///< that the writer writes to
  };

  bool endsSegment(const Side& side, const EncodedUnit& unit) const;
  void moveOn(CameraSide which, const EncodedUnit& unit);

  std::filesystem::path folder_;
  std::chrono::nanoseconds segment_length_;
  int lock_ = -1;  ///< descriptor of recording.json
  std::array<Side, 2> sides_;
  std::uint64_t segment_ = 0;             ///< the latest
  std::optional<std::int64_t> began_ns_;  ///< of that segment; nothing before the first
  std::uint64_t order_ = 0;
};

/// Whether a RecordingWriter, of any process, is at work there.
bool isBeingWritten(const std::filesystem::path& recording);

}  // namespace cartvo
