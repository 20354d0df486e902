#pragma once

#include <Eigen/Geometry>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// Whether a cart can have moved so far and turned so much in `time_step` seconds.
inline bool plausibleMotion(const Eigen::Isometry3d& motion, double time_step,
                            const ValiditySettings& validity) {
  const Vector6d vector = vectorFromMotion(motion);
  return vector.allFinite() && vector.head<3>().norm() <= validity.maximum_speed * time_step &&
         vector.tail<3>().norm() <= validity.maximum_rate * time_step;
}

/// Whether a camera that moves so (m/s and rad/s) can stand `time_step` (s) later: braked as hard as tyres
/// hold.
inline bool canStop(const Vector6d& velocity, double time_step) {
  constexpr double kHardestBraking = 10.0;   // m/s^2
  constexpr double kFastestTurnsEnd = 10.0;  // rad/s^2
  return velocity.head<3>().norm() <= kHardestBraking * time_step &&
         velocity.tail<3>().norm() <= kFastestTurnsEnd * time_step;
}

}  // namespace cartvo
