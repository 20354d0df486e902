#pragma once

#include <string>

#include "capture/rtsp_camera.hpp"
#include "daemon/pipeline.hpp"

namespace cartvo {

/// The longest a camera's reader may take to go round, s: twice what RtspCamera may spend on opening a
/// connection or on waiting for a silent one. A camera that is absent, silent or refuses keeps its reader
/// turning; a reader that hangs does not.
double longestReaderTurn(const RtspCameraSettings& settings);

/// Names the camera whose reader is stuck; empty if both go on. While one is stuck systemd's watchdog is not
/// fed. (The odometry's thread asks this between two pairs, so that when it is stuck itself nobody feeds it
/// either.)
std::string stuckReader(const PipelineProgress& progress, double longest_turn);

}  // namespace cartvo
