// Converts ground truth between body poses and left-camera poses.
#include "tools/simulate/truth.hpp"

namespace cartvo::simulate {
namespace {

// Poses relative to the first one, of another frame on the same rigid body.
Trajectory changeBodyFrame(const Trajectory& poses, const Eigen::Isometry3d& T_to_from) {
  Trajectory result;
  result.reserve(poses.size());
  for (const StampedPose& stamped : poses) {
    const Eigen::Isometry3d relative = poses.front().pose.inverse() * stamped.pose;
    result.push_back({.time_ns = stamped.time_ns, .pose = T_to_from * relative * T_to_from.inverse()});
  }
  return result;
}

}  // namespace

Trajectory bodyTrajectory(const Trajectory& camera_poses, const calib::Rig& rig) {
  return changeBodyFrame(camera_poses, rig.T_body_camera);
}

Trajectory cameraTrajectory(const Trajectory& body_poses, const calib::Rig& rig) {
  return changeBodyFrame(body_poses, rig.T_body_camera.inverse());
}

Trajectory shifted(Trajectory trajectory, std::int64_t by_ns) {
  for (StampedPose& stamped : trajectory)
    stamped.time_ns += by_ns;
  return trajectory;
}

}  // namespace cartvo::simulate
