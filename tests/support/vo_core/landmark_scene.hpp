#pragma once

#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo::test {

inline const vo::StereoCamera kRigCamera{480.0, 340.0, 210.0, 0.115, 680, 420};
constexpr double kFramePeriod = 0.055;  // s

/// Motion vector (x, y, z, rotation vector); m and rad.
inline vo::Vector6d vector6(double x, double y, double z, double rx, double ry, double rz) {
  vo::Vector6d vector;
  vector << x, y, z, rx, ry, rz;
  return vector;
}

/// Pose at `time` (s) of a drive with constant linear and angular velocity.
inline Eigen::Isometry3d steadyDrive(double time) {
  return vo::motionFromVector(time * vector6(0.1, -0.05, 2.7, 0.02, -0.3, 0.05));
}

}  // namespace cartvo::test
