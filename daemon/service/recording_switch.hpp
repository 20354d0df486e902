#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>

#include "capture/recording/stream_recorder.hpp"
#include "common/threads/mailbox.hpp"

namespace cartvo::daemon {

/// A recording and its folder; empty while nothing is recorded.
struct OpenRecording {
  std::shared_ptr<capture::StreamRecorder> recorder;
  std::filesystem::path folder;  ///< of this recording, or of the last one
};

/// Starts and stops recordings of streams that run. The threads of the cameras and of the odometry never wait
/// for it: each receives a change through a mailbox.
class RecordingSwitch {
 public:
  RecordingSwitch();
  ~RecordingSwitch();
  RecordingSwitch(const RecordingSwitch&) = delete;
  RecordingSwitch& operator=(const RecordingSwitch&) = delete;

  /// Stay the same for all recordings; must be set before the cameras are read.
  capture::StreamObserver& left();
  capture::StreamObserver& right();

  /// May be called from any thread. Returns false, and does nothing, if one is running. Throws as
  /// StreamRecorder does.
  bool start(const capture::RecordingSettings& settings);
  /// May be called from any thread. Writes what is queued. Returns false if none is running.
  bool stop();

  /// Called by the odometry's thread.
  const OpenRecording& current();

 private:
  class Side;
  void tell(const OpenRecording& recording);

  std::unique_ptr<Side> left_, right_;
  std::mutex mutex_;    ///< for the next
  OpenRecording open_;  ///< kept until the others have let go of it
  Mailbox<OpenRecording> news_;
  OpenRecording current_;  ///< of the odometry's thread
};

}  // namespace cartvo::daemon
