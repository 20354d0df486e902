// Index rows of one camera over all segments of a recording.

#include "capture/recording/recording_index_reader.hpp"

#include <stdexcept>

namespace cartvo::capture {

RecordingIndexReader::RecordingIndexReader(const std::filesystem::path& recording, CameraSide side)
    : segments_(recordingSegments(recording)), side_(side) {}

bool RecordingIndexReader::openNextSegment() {
  while (next_segment_ < segments_.size()) {
    const RecordingSegment& segment = segments_[next_segment_++];
    if (!std::filesystem::exists(segment.index(side_))) continue;
    try {
      index_ = readRecordingIndex(segment.index(side_));
    } catch (const std::runtime_error&) {
      continue;
    }
    next_row_ = 0;
    segment_ = segment.number;
    return true;
  }
  return false;
}

const IndexRow* RecordingIndexReader::next() {
  while (next_row_ == index_.rows.size()) {
    if (!openNextSegment()) return nullptr;
  }
  return &index_.rows[next_row_++];
}

}  // namespace cartvo::capture
