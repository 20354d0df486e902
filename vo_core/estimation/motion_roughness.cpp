// Estimation of the jerk from the motions about exposures.
#include "vo_core/estimation/motion_roughness.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

constexpr double kMemory = 0.9;                              // weight of the previous estimate, per pair
constexpr double kMinimumJerk = 0.25, kMaximumJerk = 4e6;    // (m/s^3)^2 and (rad/s^3)^2
constexpr double kUnknownAcceleration = 3.0;                 // m/s^2 and rad/s^2, with two poses
constexpr double kUnknownVelocity = 3.0;                     // m/s and rad/s, with one pose

/// Effect of a unit jerk on the velocity and acceleration of the parabola (error of a quadratic
/// interpolation), and of a unit noise of the motions.
struct Sensitivity {
  bool known = false;
  double velocity = 0.0;            // s^2
  double acceleration = 0.0;        // s
  double velocity_noise = 0.0;      // 1/s
  double acceleration_noise = 0.0;  // 1/s^2
};

Sensitivity sensitivityOf(std::span<const TimedPose> poses, int index) {
  Sensitivity sensitivity;
  const auto [near, far] = parabolaTimes(poses, index);
  if (far == 0.0) return sensitivity;
  sensitivity.known = true;
  sensitivity.velocity = std::abs(near * far) / 6.0;
  // Of an interpolation the jerk has no effect on the acceleration, its change has one.
  sensitivity.acceleration = std::max(std::abs(near + far) / 3.0, (std::abs(near) + std::abs(far)) / 12.0);
  const double step = std::min(std::abs(near), std::abs(far));
  const bool between = near * far < 0.0;
  sensitivity.velocity_noise = (between ? 0.7 : 1.6) / step;
  sensitivity.acceleration_noise = 1.4 / (step * step);
  return sensitivity;
}

}  // namespace

RowInformation::Vector MotionRoughness::variances(std::span<const TimedPose> poses, int index,
                                                  const Vector6d& motion_stddev) const {
  RowInformation::Vector variances;
  const Sensitivity by = sensitivityOf(poses, index);
  if (!by.known) {
    const auto [near, far] = parabolaTimes(poses, index);
    const double velocity = near == 0.0 ? kUnknownVelocity : 0.5 * std::abs(near) * kUnknownAcceleration;
    variances.head<6>().setConstant(velocity * velocity);
    variances.tail<6>().setConstant(kUnknownAcceleration * kUnknownAcceleration);
    return variances;
  }
  Vector6d jerk;
  jerk << Eigen::Vector3d::Constant(translation_jerk_), Eigen::Vector3d::Constant(rotation_jerk_);
  variances.head<6>() = by.velocity * by.velocity * jerk +
                        by.velocity_noise * by.velocity_noise * motion_stddev.cwiseAbs2();
  variances.tail<6>() = by.acceleration * by.acceleration * jerk +
                        by.acceleration_noise * by.acceleration_noise * motion_stddev.cwiseAbs2();
  return variances;
}

RowInformation::Vector MotionRoughness::variancesAfter(double time_step) const {
  RowInformation::Vector variances;
  Vector6d jerk;
  jerk << Eigen::Vector3d::Constant(translation_jerk_), Eigen::Vector3d::Constant(rotation_jerk_);
  variances << std::pow(0.5 * time_step * time_step, 2) * jerk, time_step * time_step * jerk;
  return variances;
}

void MotionRoughness::update(std::span<const TimedPose> poses, const ExposureMotion& expected,
                             const RowMotion& motion, const Vector6d& motion_stddev) {
  const Sensitivity by = sensitivityOf(poses, static_cast<int>(poses.size()) - 1);
  if (!by.known) return;
  const Vector6d difference = motion.motion.velocity - expected.velocity;
  const Vector6d noise = by.velocity_noise * by.velocity_noise * motion_stddev.cwiseAbs2();
  const Vector6d size =
      (difference.cwiseAbs2() + motion.covariance.diagonal().head<6>() - noise) / (by.velocity * by.velocity);
  const auto adapt = [](double& jerk, double seen) {
    jerk = std::clamp(kMemory * jerk + (1.0 - kMemory) * seen, kMinimumJerk, kMaximumJerk);
  };
  adapt(translation_jerk_, size.head<3>().mean());
  adapt(rotation_jerk_, size.tail<3>().mean());
}

}  // namespace cartvo::vo
