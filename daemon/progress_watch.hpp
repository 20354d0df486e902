#pragma once

#include <string>

#include "daemon/pipeline.hpp"

namespace cartvo {

/// The longest a camera's reader may take to go round, s: twice what one attempt to connect may take. A
/// camera that is absent, silent or refuses keeps its reader turning; a reader that hangs does not.
constexpr double kLongestReaderTurn = 10.0;

/// Names the camera whose reader is stuck; empty if both go on. While one is stuck systemd's watchdog is not
/// fed. (The odometry's thread asks this between two pairs, so that when it is stuck itself nobody feeds it
/// either.)
std::string stuckReader(const PipelineProgress& progress);

}  // namespace cartvo
