#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "capture/camera_side.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_index.hpp"

namespace cartvo::capture {

/// Reads the index rows of one camera's pictures, segment by segment. Skips indices that cannot be read,
/// without an error: RecordingReader reports those. Holds one segment's rows at a time.
class RecordingIndexReader {
 public:
  RecordingIndexReader(const std::filesystem::path& recording, CameraSide side);

  /// Returns the next row; null at the end. Valid until the next call.
  const IndexRow* next();

  /// Segment of the row that `next` returned.
  std::uint64_t segment() const { return segment_; }

 private:
  bool openNextSegment();

  std::vector<RecordingSegment> segments_;
  CameraSide side_;
  std::size_t next_segment_ = 0;
  std::uint64_t segment_ = 0;
  RecordingIndex index_;
  std::size_t next_row_ = 0;
};

}  // namespace cartvo::capture
