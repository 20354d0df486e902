#include "capture/recording_rows.hpp"

#include <stdexcept>

namespace cartvo {

RecordedRows::RecordedRows(const std::filesystem::path& recording, CameraSide side)
    : segments_(recordingSegments(recording)), side_(side) {}

bool RecordedRows::openNext() {
  while (next_segment_ < segments_.size()) {
    const RecordingSegment& segment = segments_[next_segment_++];
    if (!std::filesystem::exists(segment.index(side_))) continue;
    try {
      index_ = readIndex(segment.index(side_));
    } catch (const std::runtime_error&) {
      continue;
    }
    next_row_ = 0;
    segment_ = segment.number;
    return true;
  }
  return false;
}

const IndexRow* RecordedRows::next() {
  while (next_row_ == index_.rows.size()) {
    if (!openNext()) return nullptr;
  }
  return &index_.rows[next_row_++];
}

}  // namespace cartvo
