// Format and parser of a recording's index.
#include "capture/recording/recording_index.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "capture/codec/picture_checksum.hpp"
#include "common/input_file.hpp"

namespace cartvo::capture {
namespace {

constexpr std::string_view kHeader =
    "number,time_ms,order,connection,sequence,rtp,reference_us,first_arrival_ns,arrival_ns,"
    "undelayed_arrival_ns,exposure_ns,deviation_ns,instant_source,size,crc32,key,data_lost,status,line_crc32";
constexpr std::size_t kFieldCount = 19;
constexpr std::array<std::string_view, 5> kInstantSources = {"file", "sender_report", "arrival", "pictures",
                                                             "kernel"};
constexpr std::array<std::string_view, 2> kStatuses = {"good", "damaged"};

// A segment usually lasts one minute; a camera that sends no key picture extends it, but not to hours.
constexpr std::uintmax_t kMaxFileBytes = 256U << 20;
constexpr std::size_t kMaxLineLength = 1024;

std::vector<std::string_view> splitFields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos || fields.size() > kFieldCount) return fields;
    line.remove_prefix(comma + 1);
  }
}

template <typename Number>
bool parse(std::string_view text, Number& value, int base = 10) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return error == std::errc() && end == text.data() + text.size();
}

bool parseOptional(std::string_view text, std::optional<std::int64_t>& value) {
  if (text.empty()) return true;
  return parse(text, value.emplace());
}

bool parseFlag(std::string_view text, bool& value) {
  value = text == "1";
  return value || text == "0";
}

template <typename Enumeration, std::size_t size>
bool parseName(std::string_view text, const std::array<std::string_view, size>& names, Enumeration& value) {
  for (std::size_t i = 0; i < size; ++i) {
    if (text != names[i]) continue;
    value = static_cast<Enumeration>(i);
    return true;
  }
  return false;
}

/// Whether the instants lie in the years 1938 to 2116, and RTP time within 99 years: no difference of two
/// overflows.
bool isInRange(const IndexRow& row) {
  constexpr std::int64_t kLatest_ns = std::int64_t{1} << 62;
  constexpr std::int64_t kEarliest_ns = -1'000'000'000'000'000'000;
  constexpr std::int64_t kMaxTicks = std::int64_t{1} << 48;
  constexpr std::int64_t kLatestReport_us = std::int64_t{1} << 52;  // the year 2112, as CameraClockModel's
  const auto instant = [](std::int64_t ns) { return ns >= kEarliest_ns && ns <= kLatest_ns; };
  const std::int64_t reference_us = row.reference_us.value_or(0);
  return row.time_ms >= 0 && row.time_ms <= kLatest_ns / 1'000'000 && row.pts >= -kMaxTicks &&
         row.pts <= kMaxTicks && reference_us >= 0 && reference_us <= kLatestReport_us &&
         instant(row.first_arrival_ns) && instant(row.arrival_ns) && instant(row.min_delay_arrival_ns) &&
         instant(row.exposure_ns) && row.exposure_stddev_ns >= 0 && row.exposure_stddev_ns <= kLatest_ns;
}

std::string hexadecimal(std::uint32_t value) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08x", value);
  return text.data();
}

}  // namespace

std::string indexHeader() {
  return std::string(kHeader);
}

std::string formatIndexRow(const IndexRow& row) {
  std::string text;
  const auto add = [&text](const auto& field) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(field)>>)
      text += std::to_string(field);
    else
      text += field;
    text += ',';
  };
  add(row.number), add(row.time_ms), add(row.order), add(row.connection), add(row.sequence), add(row.pts);
  add(row.reference_us ? std::to_string(*row.reference_us) : "");
  add(row.first_arrival_ns), add(row.arrival_ns), add(row.min_delay_arrival_ns);
  add(row.exposure_ns), add(row.exposure_stddev_ns);
  add(kInstantSources[static_cast<std::size_t>(row.instant_source)]);
  add(row.size), add(hexadecimal(row.checksum)), add(row.key ? 1 : 0), add(row.data_lost ? 1 : 0);
  add(kStatuses[static_cast<std::size_t>(row.status)]);
  return withLineChecksum(text);
}

std::string withLineChecksum(const std::string& line) {
  const std::string payload = line.substr(0, line.rfind(','));
  return payload + ',' + hexadecimal(textChecksum(payload));
}

std::optional<IndexRow> parseIndexRow(const std::string& line) {
  if (line.size() > kMaxLineLength) return std::nullopt;
  const std::vector<std::string_view> fields = splitFields(line);
  if (fields.size() != kFieldCount) return std::nullopt;
  const std::string_view payload(line.data(), line.size() - fields.back().size() - 1);
  if (fields.back() != hexadecimal(textChecksum(payload))) return std::nullopt;
  IndexRow row;
  const bool good =
      parse(fields[0], row.number) && parse(fields[1], row.time_ms) && parse(fields[2], row.order) &&
      parse(fields[3], row.connection) && parse(fields[4], row.sequence) && parse(fields[5], row.pts) &&
      parseOptional(fields[6], row.reference_us) && parse(fields[7], row.first_arrival_ns) &&
      parse(fields[8], row.arrival_ns) && parse(fields[9], row.min_delay_arrival_ns) &&
      parse(fields[10], row.exposure_ns) && parse(fields[11], row.exposure_stddev_ns) &&
      parseName(fields[12], kInstantSources, row.instant_source) && parse(fields[13], row.size) &&
      parse(fields[14], row.checksum, 16) && parseFlag(fields[15], row.key) &&
      parseFlag(fields[16], row.data_lost) && parseName(fields[17], kStatuses, row.status);
  if (!good || !isInRange(row)) return std::nullopt;
  return row;
}

RecordingIndex readRecordingIndex(const std::filesystem::path& file) {
  std::istringstream input(readInputFile(file, kMaxFileBytes));
  return readRecordingIndex(input, file);
}

RecordingIndex readRecordingIndex(std::istream& input, const std::filesystem::path& name) {
  RecordingIndex index;
  const auto count_damaged_line = [&](int number) {
    if (index.damaged_lines++ == 0)
      index.damage = name.string() + ", line " + std::to_string(number) + " is damaged or truncated";
  };
  std::string line;
  // Editors of Windows end lines by "\r\n".
  const auto read_line = [&] {
    const bool is_read = static_cast<bool>(std::getline(input, line));
    if (line.ends_with('\r')) line.pop_back();
    return is_read;
  };
  if (!read_line() || line != kHeader) {
    // A header with other columns means another format; one that was overwritten is a damaged line.
    if (line.starts_with("number,"))
      throw std::runtime_error(name.string() + ", line 1: expected the header '" + indexHeader() + "'");
    count_damaged_line(1);
  }
  for (int number = 2; read_line(); ++number) {
    // The last line may be truncated and still parse: it is valid only with its end of line.
    const std::optional<IndexRow> row = input.eof() ? std::nullopt : parseIndexRow(line);
    const bool in_order = row && (index.rows.empty() || (row->number > index.rows.back().number &&
                                                         row->time_ms > index.rows.back().time_ms));
    if (in_order) {
      index.rows.push_back(*row);
    } else {
      count_damaged_line(number);
    }
  }
  return index;
}

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
