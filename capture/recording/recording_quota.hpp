#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace cartvo::capture {

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
