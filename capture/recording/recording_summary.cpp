// Statistics of a recording from its indices.
#include "capture/recording/recording_summary.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "capture/recording/recording_index.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/recording_writer.hpp"
#include "common/input_file.hpp"

namespace cartvo::capture {
namespace {

void readFirstPicture(const std::filesystem::path& folder, CameraSide side, RecordedCamera& camera) {
  try {
    RecordingReader reader(folder, side);
    RecordedUnit first;
    if (!reader.next(first)) return;
    camera.codec = first.format.codec;
    camera.picture_size = first.picture_size;
  } catch (const std::runtime_error&) {
    // Codec and size stay empty.
  }
}

/// Arrival of the last picture of each segment, ns, by segment number.
using LastArrivals = std::map<std::uint64_t, std::int64_t>;

RecordedCamera summarise(const std::filesystem::path& folder, CameraSide side, LastArrivals& last_arrivals) {
  RecordedCamera camera;
  RecordingIndexReader rows(folder, side);
  std::uint64_t last_connection = 0;
  std::uint64_t last_sequence = 0;
  while (const IndexRow* row = rows.next()) {
    if (camera.pictures == 0) {
      camera.first_arrival_ns = row->arrival_ns;
    } else if (row->sequence > last_sequence) {
      camera.missed += row->sequence - last_sequence - 1;
    }
    if (row->connection != last_connection) ++camera.connections;
    last_connection = row->connection;
    last_sequence = row->sequence;
    camera.last_arrival_ns = last_arrivals[rows.segment()] = row->arrival_ns;
    ++camera.pictures;
    camera.bytes += row->size;
    if (row->key) ++camera.key_pictures;
    if (row->status == FrameStatus::damaged) ++camera.damaged;
    ++camera.by_instant_source[static_cast<std::size_t>(row->instant_source)];
  }
  if (camera.pictures > 0) readFirstPicture(folder, side, camera);
  return camera;
}

void findUnfinalised(CameraSide side, const std::vector<RecordingSegment>& segments,
                     const LastArrivals& last_arrivals, RecordingSummary& summary) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const std::filesystem::path video = segments[i].video(side);
    if (!std::filesystem::exists(video) || isMatroskaFinalised(video)) continue;
    // One camera may still be writing the last segment but one.
    if (summary.being_written && i + 2 >= segments.size()) continue;
    const auto last = last_arrivals.find(segments[i].number);
    summary.unfinalised.push_back(
        {side, segments[i].number, last == last_arrivals.end() ? std::nullopt : std::optional(last->second)});
  }
}

constexpr std::uint32_t kEbmlHeader = 0x1A45DFA3;
constexpr std::uint32_t kSegment = 0x18538067;
constexpr std::uint64_t kMaxHeaderBytes = 4096;  ///< usually 40

/// Reads an identifier of four bytes, as both elements have.
std::optional<std::uint32_t> readIdentifier(std::istream& input) {
  std::uint32_t identifier = 0;
  for (int i = 0; i < 4; ++i) {
    const int byte = input.get();
    if (byte < 0) return std::nullopt;
    identifier = identifier << 8 | static_cast<std::uint32_t>(byte);
  }
  return identifier;
}

/// Reads a variable-size integer (RFC 8794): the leading zero bits give the number of further bytes. Nothing
/// if all value bits are ones, which means an unknown size.
std::optional<std::uint64_t> readSize(std::istream& input) {
  const int first = input.get();
  if (first <= 0) return std::nullopt;
  const int extra_bytes = std::countl_zero(static_cast<std::uint8_t>(first));
  std::uint64_t size = static_cast<std::uint64_t>(first) & (0x7FU >> extra_bytes);
  for (int i = 0; i < extra_bytes; ++i) {
    const int byte = input.get();
    if (byte < 0) return std::nullopt;
    size = size << 8 | static_cast<std::uint64_t>(byte);
  }
  const std::uint64_t unknown = (std::uint64_t{1} << (7 * (extra_bytes + 1))) - 1;
  return size == unknown ? std::nullopt : std::optional(size);
}

}  // namespace

RecordingSummary summariseRecording(const std::filesystem::path& folder) {
  RecordingSummary summary;
  summary.info = readRecordingInfo(folder);
  const std::vector<RecordingSegment> segments = recordingSegments(folder);
  summary.segments = segments.size();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) summary.bytes += entry.file_size();
  }
  summary.being_written = isBeingWritten(folder);
  for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
    LastArrivals last_arrivals;
    summary.cameras[static_cast<std::size_t>(side)] = summarise(folder, side, last_arrivals);
    findUnfinalised(side, segments, last_arrivals, summary);
  }
  return summary;
}

bool isMatroskaFinalised(const std::filesystem::path& matroska_file) {
  try {
    requireInputFile(matroska_file);
  } catch (const std::runtime_error&) {
    return false;
  }
  std::ifstream input(matroska_file, std::ios::binary);
  if (readIdentifier(input) != kEbmlHeader) return false;
  const std::optional<std::uint64_t> header = readSize(input);
  if (!header || *header > kMaxHeaderBytes) return false;
  input.ignore(static_cast<std::streamsize>(*header));
  return readIdentifier(input) == kSegment && readSize(input).has_value();
}

}  // namespace cartvo::capture
