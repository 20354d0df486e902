#pragma once

#include <string>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// Says that the clocks of an estimate and its truth differ, and by how much, if speeds and rates agree much
/// better with a time offset than without one; empty otherwise, also if the motion is too uniform to tell.
/// Trajectories without a common time are compared at all offsets, else the present one competes. Neither
/// trajectory may be empty.
std::string clockProblem(const Trajectory& estimate, const Trajectory& truth);

}  // namespace cartvo
