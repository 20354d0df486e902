// Decides from the pipeline's progress alone whether the watchdog may be fed.

#include "daemon/progress_watch.hpp"

#include <algorithm>
#include <chrono>

namespace cartvo {

double longestReaderTurn(const RtspCameraSettings& settings) {
  return 2.0 *
         std::chrono::duration<double>(std::max(settings.connect_timeout, settings.stall_timeout)).count();
}

std::string stuckReader(const PipelineProgress& progress, double longest_turn) {
  if (progress.left_reader > longest_turn) return "left camera's reader";
  if (progress.right_reader > longest_turn) return "right camera's reader";
  return {};
}

}  // namespace cartvo
