#pragma once

#include <string>

#include "daemon/pipeline.hpp"

namespace cartvo {

/// Names the camera whose reader is stuck, having taken longer than `longest_turn` s (LiveCamera) to go
/// round; empty if both go on. A camera that is absent, silent or refuses keeps its reader turning; a reader
/// that hangs does not. While one is stuck systemd's watchdog is not fed. (The odometry's thread asks this
/// between two pairs, so that when it is stuck itself nobody feeds it either.)
std::string stuckReader(const PipelineProgress& progress, double longest_turn);

}  // namespace cartvo
