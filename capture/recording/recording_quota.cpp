// Deletion of old segments to meet a quota of disk space.

#include "capture/recording/recording_quota.hpp"

#include <algorithm>
#include <system_error>
#include <vector>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_writer.hpp"
#include "common/exact_text.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

constexpr double kGigabyte = 1e9;

/// A segment and its disk usage.
struct SegmentUsage {
  fs::path recording;
  RecordingSegment segment;
  std::uint64_t bytes = 0;
  fs::file_time_type last_written = fs::file_time_type::min();
};

std::vector<fs::path> segmentFiles(const RecordingSegment& segment) {
  return {segment.video(CameraSide::left), segment.index(CameraSide::left), segment.video(CameraSide::right),
          segment.index(CameraSide::right)};
}

SegmentUsage measureSegment(const fs::path& recording, const RecordingSegment& segment) {
  SegmentUsage usage{recording, segment};
  for (const fs::path& file : segmentFiles(segment)) {
    std::error_code missing;
    const std::uintmax_t size = fs::file_size(file, missing);
    if (missing) continue;
    usage.bytes += size;
    usage.last_written = std::max(usage.last_written, fs::last_write_time(file, missing));
  }
  return usage;
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

/// Recorded segments, oldest first.
struct Inventory {
  std::vector<SegmentUsage> deletable;
  std::uint64_t bytes = 0;  ///< of all segments
};

Inventory buildInventory(const fs::path& recordings, const fs::path& own, std::uint64_t oldest_open) {
  Inventory inventory;
  for (const fs::path& recording : recordingsIn(recordings)) {
    const bool is_own = isSame(recording, own);
    const bool is_written_elsewhere = !is_own && isBeingWritten(recording);
    for (const RecordingSegment& segment : recordingSegments(recording)) {
      SegmentUsage usage = measureSegment(recording, segment);
      inventory.bytes += usage.bytes;
      if (is_written_elsewhere || (is_own && segment.number >= oldest_open)) continue;
      inventory.deletable.push_back(std::move(usage));
    }
  }
  return inventory;
}

/// Deletes a segment's files, and its recording if it was the last segment. False if it could not be deleted.
bool removeSegment(const SegmentUsage& usage, const fs::path& own) {
  std::error_code error;
  for (const fs::path& file : segmentFiles(usage.segment))
    fs::remove(file, error);
  if (!fs::remove(usage.segment.folder, error) || error) return false;
  if (!isSame(usage.recording, own) && recordingSegments(usage.recording).empty()) {
    fs::remove(usage.recording / "recording.json", error);
    fs::remove(usage.recording, error);  // fails if it contains other files
  }
  return true;
}

std::uint64_t freeBytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? UINT64_MAX : space.available;
}

std::string gigabytes(std::uint64_t bytes) {
  return fixedText(static_cast<double>(bytes) / kGigabyte, 2) + " GB";
}

}  // namespace

QuotaOutcome enforceQuota(const RecordingQuota& quota, const fs::path& recording, std::uint64_t oldest_open) {
  QuotaOutcome outcome;
  if (!quota.recordings.empty()) {
    Inventory inventory = buildInventory(quota.recordings, recording, oldest_open);
    const auto now = fs::file_time_type::clock::now();
    for (const SegmentUsage& usage : inventory.deletable) {
      const bool too_much = quota.maximum_bytes > 0 && inventory.bytes > quota.maximum_bytes;
      const bool too_old = quota.maximum_age.count() > 0 && now - usage.last_written > quota.maximum_age;
      const bool too_full = quota.keep_free_bytes > 0 && freeBytes(recording) < quota.keep_free_bytes;
      if (!too_much && !too_old && !too_full) break;
      if (!removeSegment(usage, recording)) continue;
      inventory.bytes -= usage.bytes;
      ++outcome.deleted_segments;
      outcome.deleted_bytes += usage.bytes;
    }
  }
  if (const std::uint64_t free = freeBytes(recording); free < quota.keep_free_bytes) {
    outcome.shortage = "only " + gigabytes(free) + " are free for " + recording.string() + "; " +
                       gigabytes(quota.keep_free_bytes) + " must be kept free";
  }
  return outcome;
}

}  // namespace cartvo::capture
