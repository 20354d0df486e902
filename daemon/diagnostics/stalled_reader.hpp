#pragma once

#include <string>

#include "daemon/pipeline/pipeline.hpp"

namespace cartvo::daemon {

/// Name of the camera reader that is stalled, i.e. whose last loop started more than `reader_timeout` s ago
/// (LiveCamera::readerTimeout); empty if none is. The reader of an absent, silent or refusing camera still
/// loops, so it is not stalled. A stalled reader triggers systemd's watchdog. The odometry's thread calls
/// this between two pairs, so a stalled odometry starves the watchdog.
std::string stalledReader(const PipelineProgress& progress, double reader_timeout);

}  // namespace cartvo::daemon
