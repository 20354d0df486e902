// Decides from the pipeline's progress alone whether the watchdog may be fed.

#include "daemon/progress_watch.hpp"

namespace cartvo {

std::string stuckReader(const PipelineProgress& progress, double longest_turn) {
  if (progress.left_reader > longest_turn) return "left camera's reader";
  if (progress.right_reader > longest_turn) return "right camera's reader";
  return {};
}

}  // namespace cartvo
