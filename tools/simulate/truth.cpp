// Changes between the two ways that ground truth is written in.
#include "tools/simulate/truth.hpp"

namespace cartvo::simulate {
namespace {

// Poses relative to the first one, carried over to another frame fixed to the same body: T_to_from says
// where.
Trajectory seenFrom(const Trajectory& poses, const Eigen::Isometry3d& T_to_from) {
  Trajectory result;
  result.reserve(poses.size());
  for (const StampedPose& stamped : poses) {
    const Eigen::Isometry3d relative = poses.front().pose.inverse() * stamped.pose;
    result.push_back({.time_ns = stamped.time_ns, .pose = T_to_from * relative * T_to_from.inverse()});
  }
  return result;
}

}  // namespace

Trajectory bodyTrajectory(const Trajectory& camera_poses, const Rig& rig) {
  return seenFrom(camera_poses, rig.T_body_camera);
}

Trajectory cameraTrajectory(const Trajectory& body_poses, const Rig& rig) {
  return seenFrom(body_poses, rig.T_body_camera.inverse());
}

Trajectory shifted(Trajectory trajectory, std::int64_t by_ns) {
  for (StampedPose& stamped : trajectory)
    stamped.time_ns += by_ns;
  return trajectory;
}

}  // namespace cartvo::simulate
