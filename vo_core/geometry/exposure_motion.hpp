#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"

// Motion of a camera around the instant of an exposure, and its effect on pixels that are exposed earlier or
// later.

namespace cartvo::vo {

/// Motion of a camera about an exposure: T_exposure_instant at u seconds after it is
/// motionFromVector(u velocity + u^2 / 2 acceleration + u^3 / 6 jerk), in the camera's axes at the exposure.
/// Only rotations have a jerk: that of a mount that vibrates moves pixels by a fifth of a pixel within a
/// picture, that of translations by less than a hundredth.
struct ExposureMotion {
  Vector6d velocity = Vector6d::Zero();                    ///< m/s and rad/s
  Vector6d acceleration = Vector6d::Zero();                ///< m/s^2 and rad/s^2
  Eigen::Vector3d angular_jerk = Eigen::Vector3d::Zero();  ///< rad/s^3

  Vector6d step(double instant) const {
    Vector6d step = instant * (velocity + 0.5 * instant * acceleration);
    step.tail<3>() += instant * instant * instant / 6.0 * angular_jerk;
    return step;
  }
  /// T_exposure_instant. Rotations up to 0.1 rad by the first terms of their series, exact to 1e-10.
  Eigen::Isometry3d at(double instant) const {
    constexpr double kSmallSquare = 0.01;  // rad^2
    const Vector6d moved = step(instant);
    const Eigen::Vector3d turn = moved.tail<3>();
    const double square = turn.squaredNorm();
    if (square > kSmallSquare) return motionFromVector(moved);
    const double first = 1.0 - square / 6.0 * (1.0 - square / 20.0);
    const double second = 0.5 - square / 24.0 * (1.0 - square / 30.0);
    Eigen::Isometry3d motion;
    motion.linear() = second * turn * turn.transpose();
    motion.linear().diagonal().array() += 1.0 - second * square;
    motion.linear() += first * skew(turn);
    motion.translation() = moved.head<3>();
    motion.makeAffine();
    return motion;
  }
};

/// Velocity, acceleration and angular jerk of a motion.
using MotionComponents = Eigen::Matrix<double, 15, 1>;
MotionComponents componentsOf(const ExposureMotion& motion);
ExposureMotion motionOf(const MotionComponents& components);

/// The motion about another instant (s), of the camera that is `T_camera_other` away in the same rig, in the
/// axes of that camera at that instant. Exact at that instant and at `range` seconds before and after it.
ExposureMotion motionAbout(const ExposureMotion& motion, double instant,
                           const Eigen::Isometry3d& T_camera_other, double range);

/// Where a pixel that is exposed `instant` seconds after the exposure would lie if it were exposed with it,
/// px. `inverse_depth`: 1/m, of the point along the z axis of the camera at the exposure. Rotations to second
/// order.
inline Eigen::Vector2d pixelAtExposure(const StereoCamera& camera, const ExposureMotion& motion,
                                       double instant, const Eigen::Vector2d& pixel, double inverse_depth) {
  constexpr double kNearest = 0.1;  // share of the depth that the camera may approach the point by
  const Vector6d step = motion.step(instant);
  const Eigen::Vector3d turn = step.tail<3>(), shift = step.head<3>();
  const Eigen::Vector3d ray((pixel.x() - camera.cx) / camera.focal_length,
                            (pixel.y() - camera.cy) / camera.focal_length, 1.0);
  const Eigen::Vector3d turned = ray + turn.cross(ray + 0.5 * turn.cross(ray));
  const double approach = std::max(1.0 - inverse_depth * shift.z(), kNearest);
  return project(camera, turned + turned.z() * inverse_depth / approach * shift);
}

}  // namespace cartvo::vo
