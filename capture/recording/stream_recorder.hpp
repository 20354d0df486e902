#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "capture/encoded_unit.hpp"
#include "capture/recording/recording_folder.hpp"

// Recording of both cameras in a separate thread.

namespace cartvo::capture {

/// Longest part of a recording that a power cut can lose, if the disk is fast enough.
inline constexpr std::chrono::milliseconds kMaxPowerCutLoss{1000};

/// Settings of a recording. Configuration and rig are stored with it, so that a replay is equal to the live
/// run.
struct RecordingSettings {
  std::filesystem::path folder;  ///< created if missing; must not contain a recording
  std::string configuration;     ///< configuration in effect, without credentials
  std::string rig;               ///< text of the rig file
  RecordingQuota quota{};
  std::chrono::milliseconds segment_length{60'000};
  std::chrono::milliseconds quota_interval{10'000};  ///< between two checks of the quota
  /// Free space required in addition to `quota.keep_free_bytes` before a stopped recording resumes, bytes.
  std::uint64_t resume_margin_bytes = 100'000'000;
  std::size_t queue_bytes = 32U << 20;  ///< maximum queue for a slow disk; half a minute at 2 x 4 Mbit/s
};

/// Snapshot of the recorder's health.
struct RecorderHealth {
  std::uint64_t units = 0;             ///< pictures written, of both cameras
  std::uint64_t bytes = 0;             ///< of the pictures written
  std::uint64_t dropped_pictures = 0;  ///< not recorded because the disk was too slow
  std::uint64_t missing_pictures = 0;  ///< not recorded while it was stopped, and then up to a key picture
  std::uint64_t deleted_bytes = 0;     ///< old segments deleted for the quota
  std::uint64_t resumptions = 0;       ///< number of times that recording resumed after a stop
  std::string error;                   ///< why recording stopped; empty while it is running
};

/// Records both cameras' streams as received, without re-encoding, in segments (recording_folder.hpp). A
/// separate thread writes, so that a slow disk does not block a camera: pictures that exceed the queue are
/// dropped up to the next key picture, and counted. Data older than kMaxPowerCutLoss survive a power cut. A
/// full or failing disk stops the recording, never the capture; it resumes in a new segment once the disk can
/// be written again.
///
/// Each side may be called from its own thread, `health` from any thread.
class StreamRecorder {
 public:
  /// Throws std::runtime_error if the folder cannot be written or already contains a recording. With less
  /// free space than the quota requires, it begins in the stopped state.
  explicit StreamRecorder(const RecordingSettings& settings);
  /// Calls `finish`.
  ~StreamRecorder();
  StreamRecorder(const StreamRecorder&) = delete;
  StreamRecorder& operator=(const StreamRecorder&) = delete;

  StreamObserver& left();
  StreamObserver& right();
  RecorderHealth health() const;

  /// Writes the queue and finalises the files; later pictures are ignored.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::capture
