// Index of a recorded stream: a CSV file with one line per picture, in the order of the video file. Each line
// has a checksum, so that a line that was cut or overwritten is detected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording/recording_folder.hpp"

namespace cartvo::capture {

/// Index entry of one picture, without slew_ns and decoded_ns.
struct IndexRow : FrameTimestamps {
  std::uint64_t number = 0;      ///< counts the file's pictures from 0
  std::int64_t time_ms = 0;      ///< time stamp in the video file; matches the row to its picture
  std::uint64_t connection = 0;  ///< counts the camera's connections from 1
  std::int64_t pts = 0;
  std::optional<std::int64_t> reference_us;
  std::int64_t first_arrival_ns = 0;
  std::uint64_t size = 0;      ///< as received, bytes
  std::uint32_t checksum = 0;  ///< of the picture (pictureChecksum)
  bool key = false;
  bool data_lost = false;
  FrameStatus status = FrameStatus::good;
};

/// The first line, without end of line: the names of the columns. `crc32` is the checksum of the picture
/// (pictureChecksum), `line_crc32` that of the line up to its last comma; both CRC-32 (IEEE 802.3),
/// hexadecimal.
std::string indexHeader();

/// The row as a line with its checksum, without end of line.
std::string formatIndexRow(const IndexRow& row);

/// The line with its last field replaced by the checksum of the others.
std::string withLineChecksum(const std::string& line);

/// Parses a line; nothing if it is truncated, damaged or out of range.
std::optional<IndexRow> parseIndexRow(const std::string& line);

/// Content of an index file.
struct RecordingIndex {
  std::vector<IndexRow> rows;       ///< the intact rows, in increasing order of number and time
  std::uint64_t damaged_lines = 0;  ///< lines that are damaged or out of order
  std::string damage;               ///< file and line of the first damaged line; empty if there is none
};

/// Reads all intact rows. Throws std::runtime_error if the file cannot be opened, is not an index of this
/// format, or is larger than 256 MiB.
RecordingIndex readRecordingIndex(const std::filesystem::path& file);

/// As above, from a stream; `name` is the file name for messages.
RecordingIndex readRecordingIndex(std::istream& input, const std::filesystem::path& name);

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
