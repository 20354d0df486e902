// Statistics of a recording from its indices.

#include "capture/recording/recording_summary.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

#include "capture/recording/matroska_file.hpp"
#include "capture/recording/recording_index_reader.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/recording_writer.hpp"

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

}  // namespace cartvo::capture
