#pragma once

// The text beside each recorded stream: one line for each picture, in the order of the file. Not for use
// outside capture.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/encoded_unit.hpp"

namespace cartvo {

inline constexpr int kRecordingFormatVersion = 1;

/// What the index says of one picture.
struct IndexRow {
  std::uint64_t number = 0;  ///< counts the file's pictures from 0
  std::int64_t time_ms = 0;  ///< its time stamp in the video file, by which the two are matched
  std::uint64_t sequence = 0;
  std::int64_t pts = 0;
  std::int64_t exposure_ns = 0;
  std::int64_t arrival_ns = 0;
  InstantSource instant_source = InstantSource::arrival;
  std::uint64_t size = 0;  ///< bytes as received
  bool key = false;
  FrameStatus status = FrameStatus::good;
};

/// The first line, without the end of line.
std::string indexHeader();

std::string toText(const IndexRow& row);

/// Nothing if the line is cut short or is not a row.
std::optional<IndexRow> parseIndexRow(const std::string& line);

struct Index {
  std::vector<IndexRow> rows;  ///< up to the first damaged line
  std::string damage;          ///< file, line and what is wrong there; empty if all is well
};

/// Throws std::runtime_error if the file cannot be read or is no index.
Index readIndex(const std::filesystem::path& file);

}  // namespace cartvo
