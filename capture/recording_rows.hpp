#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "capture/camera_side.hpp"
#include "capture/recording_folder.hpp"
#include "capture/recording_index.hpp"

namespace cartvo {

/// What the indices say of one camera's pictures, segment after segment; those that cannot be read are left
/// out, because RecordingReader tells of them. Holds one segment's rows at a time.
class RecordedRows {
 public:
  RecordedRows(const std::filesystem::path& recording, CameraSide side);

  /// The next row; null at the end. Valid until the next call.
  const IndexRow* next();

  /// Of the row that `next` gave.
  std::uint64_t segment() const { return segment_; }

 private:
  bool openNext();

  std::vector<RecordingSegment> segments_;
  CameraSide side_;
  std::size_t next_segment_ = 0;
  std::uint64_t segment_ = 0;
  Index index_;
  std::size_t next_row_ = 0;
};

}  // namespace cartvo
