#include "capture/recording_quota.hpp"

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <vector>

#include "capture/recording_folder.hpp"
#include "capture/recording_writer.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

constexpr double kGigabyte = 1e9;

/// A segment that may be deleted, and what it takes.
struct Candidate {
  fs::path recording;
  RecordingSegment segment;
  std::uint64_t bytes = 0;
  fs::file_time_type last_written = fs::file_time_type::min();
};

std::vector<fs::path> segmentFiles(const RecordingSegment& segment) {
  return {segment.video(CameraSide::left), segment.index(CameraSide::left), segment.video(CameraSide::right),
          segment.index(CameraSide::right)};
}

Candidate measured(const fs::path& recording, const RecordingSegment& segment) {
  Candidate candidate{recording, segment};
  for (const fs::path& file : segmentFiles(segment)) {
    std::error_code missing;
    const std::uintmax_t size = fs::file_size(file, missing);
    if (missing) continue;
    candidate.bytes += size;
    candidate.last_written = std::max(candidate.last_written, fs::last_write_time(file, missing));
  }
  return candidate;
}

std::vector<fs::path> recordingsIn(const fs::path& folder) {
  std::vector<fs::path> recordings;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory() && !entry.is_symlink() && isRecording(entry.path()))
      recordings.push_back(entry.path());
  }
  std::sort(recordings.begin(), recordings.end());
  return recordings;
}

bool isSame(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error);
}

/// What there is, oldest first.
struct Inventory {
  std::vector<Candidate> deletable;
  std::uint64_t bytes = 0;  ///< of all
};

Inventory takeInventory(const fs::path& recordings, const fs::path& own, std::uint64_t oldest_open) {
  Inventory inventory;
  for (const fs::path& recording : recordingsIn(recordings)) {
    const bool is_own = isSame(recording, own);
    const bool others = !is_own && isBeingWritten(recording);
    for (const RecordingSegment& segment : recordingSegments(recording)) {
      Candidate candidate = measured(recording, segment);
      inventory.bytes += candidate.bytes;
      if (others || (is_own && segment.number >= oldest_open)) continue;
      inventory.deletable.push_back(std::move(candidate));
    }
  }
  return inventory;
}

bool remove(const Candidate& candidate, const fs::path& own) {
  std::error_code error;
  for (const fs::path& file : segmentFiles(candidate.segment))
    fs::remove(file, error);
  if (!fs::remove(candidate.segment.folder, error) || error) return false;
  if (!isSame(candidate.recording, own) && recordingSegments(candidate.recording).empty()) {
    fs::remove(candidate.recording / "recording.json", error);
    fs::remove(candidate.recording, error);  // not if something else lies in it
  }
  return true;
}

std::uint64_t freeBytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? UINT64_MAX : space.available;
}

std::string gigabytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f GB", static_cast<double>(bytes) / kGigabyte);
  return text;
}

}  // namespace

QuotaOutcome enforceQuota(const RecordingQuota& quota, const fs::path& recording, std::uint64_t oldest_open) {
  QuotaOutcome outcome;
  if (!quota.recordings.empty()) {
    Inventory inventory = takeInventory(quota.recordings, recording, oldest_open);
    const auto now = fs::file_time_type::clock::now();
    for (const Candidate& candidate : inventory.deletable) {
      const bool too_much = quota.maximum_bytes > 0 && inventory.bytes > quota.maximum_bytes;
      const bool too_old = quota.maximum_age.count() > 0 && now - candidate.last_written > quota.maximum_age;
      const bool too_full = quota.keep_free_bytes > 0 && freeBytes(recording) < quota.keep_free_bytes;
      if (!too_much && !too_old && !too_full) break;
      if (!remove(candidate, recording)) continue;
      inventory.bytes -= candidate.bytes;
      ++outcome.deleted_segments;
      outcome.deleted_bytes += candidate.bytes;
    }
  }
  if (const std::uint64_t free = freeBytes(recording); free < quota.keep_free_bytes) {
    outcome.short_of_room = "only " + gigabytes(free) + " are free for " + recording.string() +
                            ", of which " + gigabytes(quota.keep_free_bytes) + " are kept for others";
  }
  return outcome;
}

}  // namespace cartvo
