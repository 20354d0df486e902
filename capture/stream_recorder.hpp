#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "capture/encoded_unit.hpp"
#include "capture/recording_quota.hpp"

namespace cartvo {

/// What a power cut costs of a recording at most, with a disk that keeps up.
inline constexpr std::chrono::milliseconds kMostLostAtAPowerCut{1000};

/// What is written beside the streams so that a replay can do what the pipeline did, and how.
struct RecordingSettings {
  std::filesystem::path folder;  ///< created if it is not there; must not hold a recording yet
  std::string configuration;     ///< the configuration in effect, without credentials
  std::string rig;               ///< the rig file's text
  RecordingQuota quota{};
  std::chrono::milliseconds segment_length{60'000};
  std::chrono::milliseconds quota_interval{10'000};  ///< between two looks at the quota
  /// That must be free besides `quota.keep_free_bytes` before a recording that stopped begins again.
  std::uint64_t room_to_begin_again = 100'000'000;
  std::size_t queue_bytes = 32U << 20;  ///< that may wait for a slow disk; half a minute at 2 x 4 Mbit/s
};

struct RecorderHealth {
  std::uint64_t units = 0;          ///< pictures written, of both cameras
  std::uint64_t bytes = 0;          ///< of these
  std::uint64_t left_out = 0;       ///< pictures that the disk was too slow for
  std::uint64_t deleted_bytes = 0;  ///< of old segments, for the quota
  std::uint64_t resumptions = 0;    ///< times that recording began again after it had stopped
  std::string error;                ///< why recording stopped; empty while it goes on
};

/// Writes both cameras' streams as received, without re-encoding, in segments (recording_folder.hpp). A
/// thread of its own writes, so that a slow disk holds no camera up: what it has no room for is left out, up
/// to the next key picture, and counted. What is older than a second survives a power cut. A full disk or a
/// failing one stops the recording, never the capture; with room again, and the disk well, it goes on in a
/// new segment.
///
/// Each side may be fed by a thread of its own; `health` may be called from any.
class StreamRecorder {
 public:
  /// Throws std::runtime_error if the folder cannot be written or holds a recording already. Without room it
  /// begins as one that stopped.
  explicit StreamRecorder(const RecordingSettings& settings);
  /// As `finish`.
  ~StreamRecorder();
  StreamRecorder(const StreamRecorder&) = delete;
  StreamRecorder& operator=(const StreamRecorder&) = delete;

  StreamObserver& left();
  StreamObserver& right();
  RecorderHealth health() const;

  /// Writes what waits and ends the files properly; what comes later is ignored.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
