// Decides from the pipeline's progress alone whether the watchdog may be fed.

#include "daemon/progress_watch.hpp"

namespace cartvo {

std::string stuckReader(const PipelineProgress& progress) {
  if (progress.left_reader > kLongestReaderTurn) return "left camera's reader";
  if (progress.right_reader > kLongestReaderTurn) return "right camera's reader";
  return {};
}

}  // namespace cartvo
