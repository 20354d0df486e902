#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace cartvo {

/// How much room recordings may take. Zeros: no bound.
struct RecordingQuota {
  /// Holds the recordings that are one's own to delete, each in a folder; empty: nothing is deleted.
  std::filesystem::path recordings;
  std::uint64_t maximum_bytes = 0;      ///< of all in `recordings`
  std::chrono::seconds maximum_age{0};  ///< since a segment was last written to
  std::uint64_t keep_free_bytes = 0;    ///< on the disk
};

/// What came of enforcing a quota.
struct QuotaOutcome {
  std::uint64_t deleted_segments = 0;
  std::uint64_t deleted_bytes = 0;
  std::string
      short_of_room;  ///< why the recording must stop: less is free than must be; empty if all is well
};

/// Deletes the oldest segments, of the oldest recording first (their folders are named by their instants),
/// until the quota is met. Never one from `oldest_open` on of `recording`, nor any of a recording that
/// another process writes to, nor anything that is not a segment's file. A recording that has no segment left
/// goes, too. What cannot be deleted is left.
QuotaOutcome enforceQuota(const RecordingQuota& quota, const std::filesystem::path& recording,
                          std::uint64_t oldest_open);

}  // namespace cartvo
