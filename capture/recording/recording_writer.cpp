// Segments of a recording, and its lock.

#include "capture/recording/recording_writer.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "capture/recording/stream_writer.hpp"
#include "common/durable_file.hpp"

namespace cartvo::capture {
namespace {

void prepareFolder(const std::filesystem::path& folder) {
  refuseLinkOfOthers(folder);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error("cannot create the folder " + folder.string() + ": " + error.message());
  if (isRecording(folder)) {
    throw std::runtime_error(folder.string() + " already contains a recording; choose another folder");
  }
  if (!std::filesystem::is_empty(folder, error) || error) {
    throw std::runtime_error(
        folder.string() +
        " is not empty; name a new folder, so that other files do not mix with the recording");
  }
}

int openDescriptionFile(const std::filesystem::path& folder) {
  return ::open((folder / "recording.json").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

}  // namespace

RecordingWriter::RecordingWriter(std::filesystem::path folder, const RecordingInfo& info,
                                 std::chrono::nanoseconds segment_length)
    : folder_(std::move(folder)), segment_length_(segment_length) {
  prepareFolder(folder_);
  writeRecordingInfo(folder_, info);
  lock_ = openDescriptionFile(folder_);
  ::flock(lock_, LOCK_EX | LOCK_NB);  // if it fails, only another process's quota does not see the lock
}

RecordingWriter::~RecordingWriter() {
  if (lock_ >= 0) ::close(lock_);
}

void RecordingWriter::beginConnection(CameraSide which, const StreamFormat& format) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  side.format = format;
  ++side.connection;
}

bool RecordingWriter::write(CameraSide which, EncodedUnit unit) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  if (!side.format) return false;
  if (unit.key) openSegmentFor(which, unit);
  if (!side.writer || side.writer->codec() != side.format->codec) return false;
  unit.order = ++order_;
  side.writer->write(unit, *side.format, side.connection);
  return true;
}

/// Whether the key picture begins a new segment: the current one is long enough, the codec changed, or the
/// host's clock was set.
bool RecordingWriter::beginsNewSegment(const Side& side, const EncodedUnit& unit) const {
  if (!began_ns_) return true;
  if (side.segment != segment_) return false;
  const bool long_enough = std::abs(unit.arrival_ns - *began_ns_) >= segment_length_.count();
  return long_enough || (side.writer && side.writer->codec() != side.format->codec);
}

/// Opens the segment that this key picture of the camera belongs to, unless it is open.
void RecordingWriter::openSegmentFor(CameraSide which, const EncodedUnit& unit) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  if (beginsNewSegment(side, unit)) {
    if (began_ns_) ++segment_;
    began_ns_ = unit.arrival_ns;
  }
  if (side.writer && side.segment == segment_) return;
  if (side.writer) {
    side.writer->sync();
    side.writer.reset();
  }
  const RecordingSegment segment = recordingSegment(folder_, segment_);
  refuseLink(segment.folder);
  std::error_code error;
  std::filesystem::create_directory(segment.folder, error);
  if (error) {
    throw std::runtime_error("cannot create the folder " + segment.folder.string() + ": " + error.message());
  }
  syncToDisk(folder_);
  side.segment = segment_;
  side.writer = std::make_unique<StreamWriter>(segment, which, *side.format, unit, *began_ns_);
}

void RecordingWriter::sync() {
  for (const Side& side : sides_) {
    if (side.writer) side.writer->sync();
  }
}

void RecordingWriter::endSegment() noexcept {
  for (Side& side : sides_)
    side.writer.reset();
  if (!began_ns_) return;
  ++segment_;
  began_ns_.reset();
}

std::uint64_t RecordingWriter::oldestOpenSegment() const {
  std::uint64_t oldest = began_ns_ || segment_ == 0 ? segment_ : segment_ - 1;
  for (const Side& side : sides_) {
    if (side.writer) oldest = std::min(oldest, side.segment);
  }
  return oldest;
}

bool isBeingWritten(const std::filesystem::path& recording) {
  const int descriptor = openDescriptionFile(recording);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  ::close(descriptor);
  return locked;
}

}  // namespace cartvo::capture
