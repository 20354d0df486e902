#include "capture/recording_summary.hpp"

#include <algorithm>
#include <stdexcept>

#include "capture/recording_reader.hpp"
#include "capture/recording_rows.hpp"
#include "capture/recording_writer.hpp"

namespace cartvo {
namespace {

void readFirstPicture(const std::filesystem::path& folder, CameraSide side, RecordedCamera& camera) {
  try {
    RecordingReader reader(folder, side);
    RecordedUnit first;
    if (!reader.next(first)) return;
    camera.codec = first.format.codec;
    camera.picture_size = first.picture_size;
  } catch (const std::runtime_error&) {
    // That nothing can be read is what the summary says.
  }
}

RecordedCamera summarise(const std::filesystem::path& folder, CameraSide side) {
  RecordedCamera camera;
  RecordedRows rows(folder, side);
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
    camera.last_arrival_ns = row->arrival_ns;
    ++camera.pictures;
    camera.bytes += row->size;
    if (row->key) ++camera.key_pictures;
    if (row->status == FrameStatus::damaged) ++camera.damaged;
    ++camera.by_instant_source[static_cast<std::size_t>(row->instant_source)];
  }
  if (camera.pictures > 0) readFirstPicture(folder, side, camera);
  return camera;
}

}  // namespace

RecordingSummary summariseRecording(const std::filesystem::path& folder) {
  RecordingSummary summary;
  summary.info = readRecordingInfo(folder);
  summary.segments = recordingSegments(folder).size();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) summary.bytes += entry.file_size();
  }
  summary.being_written = isBeingWritten(folder);
  summary.cameras = {summarise(folder, CameraSide::left), summarise(folder, CameraSide::right)};
  return summary;
}

}  // namespace cartvo
