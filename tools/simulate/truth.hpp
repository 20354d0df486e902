#pragma once

#include <cstdint>

#include "calib/model/rig.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::simulate {

// Conversions between body poses (T_world_body; world: body axes at the start) and KITTI poses of the left
// camera relative to the first one, in the rig's own axes. Timestamps are kept.

/// Body poses of the left camera's KITTI poses.
Trajectory bodyTrajectory(const Trajectory& camera_poses, const calib::Rig& rig);
/// KITTI poses of the left camera of body poses.
Trajectory cameraTrajectory(const Trajectory& body_poses, const calib::Rig& rig);

/// The same poses with `by_ns` added to their timestamps.
Trajectory shifted(Trajectory trajectory, std::int64_t by_ns);

}  // namespace cartvo::simulate
