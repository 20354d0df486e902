#pragma once

#include <Eigen/Geometry>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

/// Whether a cart can make this motion in `time_step` seconds: within the maximum speed and angular rate.
inline bool isPlausibleMotion(const Eigen::Isometry3d& motion, double time_step,
                              const ValiditySettings& validity) {
  const Vector6d vector = vectorFromMotion(motion);
  return vector.allFinite() && vector.head<3>().norm() <= validity.maximum_speed * time_step &&
         vector.tail<3>().norm() <= validity.maximum_rate * time_step;
}

/// Whether a camera of this velocity (m/s and rad/s) can come to a standstill in `time_step` (s), braking as
/// hard as tyres allow.
inline bool canStop(const Vector6d& velocity, double time_step) {
  constexpr double kMaximumDeceleration = 10.0;         // m/s^2
  constexpr double kMaximumAngularDeceleration = 10.0;  // rad/s^2
  return velocity.head<3>().norm() <= kMaximumDeceleration * time_step &&
         velocity.tail<3>().norm() <= kMaximumAngularDeceleration * time_step;
}

}  // namespace cartvo::vo
