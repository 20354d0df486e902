#pragma once

#include <string>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Text of `odometry.csv`: the messages as cartvod publishes them, one row per pair, with units in the names
/// of the columns. Covariances are the upper triangles, row by row, in the order and units of odometry_t.
/// Values that a message does not know are empty.
std::string odometryCsv(const Replay& replay);

}  // namespace cartvo
