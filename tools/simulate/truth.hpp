#pragma once

#include <cstdint>

#include "calib/rig.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::simulate {

// The cart's motion as poses of its body (T_world_body, world: the body axes at the start) and as poses of
// its left camera relative to the first one (KITTI), in the rig's own axes. Instants are kept.

Trajectory bodyTrajectory(const Trajectory& camera_poses, const Rig& rig);
Trajectory cameraTrajectory(const Trajectory& body_poses, const Rig& rig);

/// The same poses, `by_ns` later.
Trajectory shifted(Trajectory trajectory, std::int64_t by_ns);

}  // namespace cartvo::simulate
