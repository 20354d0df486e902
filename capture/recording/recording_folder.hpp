#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/camera_side.hpp"

// Folder layout and description file (recording.json) of a recording.

namespace cartvo::capture {

/// Version of the recording format. A recording is a folder that contains recording.json and one folder per
/// segment of about one minute (000000, 000001, ...) with left.mkv and right.mkv, the streams as received,
/// and left.csv and right.csv, their indices. Format 1 (before any release) had no segments.
inline constexpr int kRecordingFormatVersion = 2;

/// Content of recording.json.
struct RecordingInfo {
  int format_version = kRecordingFormatVersion;
  std::string software_version;  ///< version of cartvo that made the recording
  std::int64_t started_ns = 0;   ///< start, ns since the Unix epoch, host's clock
  std::string configuration;     ///< configuration in effect, without credentials
  std::string rig;               ///< text of the rig file
};

/// Whether the folder contains a recording.json.
bool isRecording(const std::filesystem::path& folder);

/// Reads recording.json. Throws std::runtime_error if it is missing, damaged or of another format version.
RecordingInfo readRecordingInfo(const std::filesystem::path& folder);

/// As above, from its text; `file` is its name for error messages.
RecordingInfo parseRecordingInfo(const std::string& text, const std::filesystem::path& file);

/// Writes recording.json durably. Throws std::runtime_error naming the file and the reason.
void writeRecordingInfo(const std::filesystem::path& folder, const RecordingInfo& info);

/// Number, folder and files of one segment.
struct RecordingSegment {
  std::uint64_t number = 0;
  std::filesystem::path folder;

  std::filesystem::path video(CameraSide side) const {
    return folder / (sideName(side) + std::string(".mkv"));
  }
  std::filesystem::path index(CameraSide side) const {
    return folder / (sideName(side) + std::string(".csv"));
  }
};

/// The segment with that number; does not access the disk.
RecordingSegment recordingSegment(const std::filesystem::path& recording, std::uint64_t number);

/// Lists the segments, oldest first. The first ones may have been deleted by the quota. Throws
/// std::filesystem::filesystem_error if the folder cannot be read.
std::vector<RecordingSegment> recordingSegments(const std::filesystem::path& recording);

/// Limits on the disk space of recordings. Zero: no limit.
struct RecordingQuota {
  /// Folder whose subfolders are recordings that may be deleted; empty: nothing is deleted.
  std::filesystem::path recordings;
  std::uint64_t maximum_bytes = 0;      ///< of all recordings in `recordings`
  std::chrono::seconds maximum_age{0};  ///< since the last write to a segment
  std::uint64_t keep_free_bytes = 0;    ///< on the disk, for other users
};

/// Result of enforcing a quota.
struct QuotaOutcome {
  std::uint64_t deleted_segments = 0;
  std::uint64_t deleted_bytes = 0;
  std::string
      shortage;  ///< error message if less than keep_free_bytes is free: recording must stop; else empty
};

/// Deletes the oldest segments, of the oldest recording first (in the order of the folders' names, which are
/// times), until the quota is met, and recordings without segments. Never deletes segments of `recording`
/// from `oldest_open` on, recordings that another process is writing, or files that do not belong to a
/// segment. Ignores segments that cannot be deleted.
QuotaOutcome enforceQuota(const RecordingQuota& quota, const std::filesystem::path& recording,
                          std::uint64_t oldest_open);

}  // namespace cartvo::capture
