#pragma once

#include <cstdint>
#include <string>

#include "capture/recording/stream_recorder.hpp"
#include "daemon/diagnostics/log.hpp"
#include "daemon/page/health_json.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/live_camera.hpp"
#include "daemon/service/recording_switch.hpp"

namespace cartvo::daemon {

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
