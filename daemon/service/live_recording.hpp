#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "capture/recording/stream_recorder.hpp"
#include "common/threads/handover_queue.hpp"
#include "daemon/diagnostics/log.hpp"
#include "daemon/page/health_json.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/live_camera.hpp"

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

/// Name of a recording's folder: the time (UTC), so that a restarted service does not fail on the folder of
/// its previous run.
std::string recordingFolderName();

/// Why no recording can be written where the configuration or --record says; empty: nothing is known that
/// hinders it.
std::string recordingObstacle(const Configuration& configuration);

/// Recording of the daemon's cameras as configured. A failure is logged and reported but does not stop the
/// daemon, because controllers need the motion; at the start with --record it does.
class LiveRecording {
 public:
  explicit LiveRecording(const Configuration& configuration) : configuration_(configuration) {}

  /// Receives the streams of the cameras, which this object must outlive, and starts to record them if the
  /// configuration says so. Call it before the cameras are read. Throws std::runtime_error if the
  /// recording of --record cannot be started.
  void observe(LiveCamera& left, LiveCamera& right);

  // May be called from any thread, for the status page: in a new folder, with the same quota. Both return why
  // it was not done; empty: it was.

  std::string start();
  std::string stop();

  // Called by the odometry's thread.

  /// Problem since the last call; empty if none.
  std::string problem(RepeatedWarnings& warnings);
  RecordingState state();

 private:
  capture::RecordingSettings settings() const;
  std::string startIn(const std::filesystem::path& folder);

  const Configuration configuration_;
  RecordingSwitch switch_;
  std::string refused_;  ///< why it could not start with the daemon
  std::string error_;    ///< as of the last call of problem(), as are the next two
  std::uint64_t dropped_pictures_ = 0;
  std::uint64_t resumptions_ = 0;
};

}  // namespace cartvo::daemon
