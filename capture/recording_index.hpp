#pragma once

// The text beside each recorded stream: one line for each picture, in the order of the file, with a checksum
// of its own, so that a line that was cut or overwritten is recognised.

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "capture/encoded_unit.hpp"

namespace cartvo {

/// What the index says of one picture. Instants are those of EncodedUnit.
struct IndexRow {
  std::uint64_t number = 0;      ///< counts the file's pictures from 0
  std::int64_t time_ms = 0;      ///< its time stamp in the video file, by which the two are matched
  std::uint64_t order = 0;       ///< counts the recording's pictures of both cameras from 1, as they came
  std::uint64_t connection = 0;  ///< counts the camera's connections from 1
  std::uint64_t sequence = 0;
  std::int64_t pts = 0;
  std::optional<std::int64_t> reference_us;
  std::int64_t first_arrival_ns = 0;
  std::int64_t arrival_ns = 0;
  std::int64_t undelayed_arrival_ns = 0;
  std::int64_t exposure_ns = 0;
  std::int64_t exposure_deviation_ns = 0;
  InstantSource instant_source = InstantSource::arrival;
  std::uint64_t size = 0;      ///< bytes as received
  std::uint32_t checksum = 0;  ///< of the picture (pictureChecksum)
  bool key = false;
  bool data_lost = false;
  FrameStatus status = FrameStatus::good;
};

/// The first line, without the end of line: the columns' names. `crc32` is of the picture (pictureChecksum),
/// `line_crc32` of the line before its last comma; both are CRC-32 (IEEE 802.3), hexadecimal.
std::string indexHeader();

std::string toText(const IndexRow& row);

/// The line with its last field, whatever it was, replaced by the checksum of the others.
std::string withLineChecksum(const std::string& line);

/// Nothing if the line is cut short, damaged or no row.
std::optional<IndexRow> parseIndexRow(const std::string& line);

struct Index {
  std::vector<IndexRow> rows;       ///< all that are in order, by their numbers
  std::uint64_t damaged_lines = 0;  ///< that are not
  std::string damage;  ///< file, line and what is wrong with the first of them; empty if all is well
};

/// Reads what can be read. Throws std::runtime_error if the file cannot be opened, is no index of this
/// format, or is far larger than a segment's.
Index readIndex(const std::filesystem::path& file);

/// The same of a stream; `name` stands for the file.
Index readIndex(std::istream& input, const std::filesystem::path& name);

}  // namespace cartvo
