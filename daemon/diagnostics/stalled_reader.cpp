// Finds a stalled camera reader, which needs a restart of the daemon.

#include "daemon/diagnostics/stalled_reader.hpp"

namespace cartvo::daemon {

std::string stalledReader(const PipelineProgress& progress, double reader_timeout) {
  if (progress.left_reader > reader_timeout) return "left camera's reader";
  if (progress.right_reader > reader_timeout) return "right camera's reader";
  return {};
}

}  // namespace cartvo::daemon
