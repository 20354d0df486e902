// Estimation of the jerk from what the rows of images show.
#include "vo_core/rolling_shutter/motion_roughness.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

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

void MotionRoughness::Excess::update(double squared, double expected, double memory) {
  squared_ = memory * squared_ + (1.0 - memory) * squared;
  expected_ = memory * expected_ + (1.0 - memory) * expected;
}

double MotionRoughness::Excess::excess() const {
  return ratio() < MotionBlend::kSignificance ? 0.0 : measured();
}

double MotionRoughness::Excess::measured() const {
  return std::max(squared_ - expected_, 0.0);
}

/// Variances of the jerk: those of a smooth drive and an excess.
Vector6d MotionRoughness::withExcess(double translation, double rotation) const {
  Vector6d jerk;
  jerk << Eigen::Vector3d::Constant(settings_.jerk_variance + translation),
      Eigen::Vector3d::Constant(settings_.jerk_variance + rotation);
  return jerk;
}

RowInformation::Vector MotionRoughness::variancesWith(const Vector6d& jerk, std::span<const TimedPose> poses,
                                                      int index, const Vector6d& motion_stddev) const {
  RowInformation::Vector variances;
  const Sensitivity by = sensitivityOf(poses, index);
  if (!by.known) {
    const auto [near, far] = parabolaTimes(poses, index);
    const double velocity =
        near == 0.0 ? settings_.unknown_velocity : 0.5 * std::abs(near) * settings_.unknown_velocity;
    variances.head<6>().setConstant(velocity * velocity);
    variances.segment<6>(6).setConstant(settings_.unknown_velocity * settings_.unknown_velocity);
    variances.tail<3>() = jerk.tail<3>();
    return variances;
  }
  variances.head<6>() =
      by.velocity * by.velocity * jerk + by.velocity_noise * by.velocity_noise * motion_stddev.cwiseAbs2();
  variances.segment<6>(6) = by.acceleration * by.acceleration * jerk +
                            by.acceleration_noise * by.acceleration_noise * motion_stddev.cwiseAbs2();
  variances.tail<3>() = jerk.tail<3>();
  return variances;
}

RowInformation::Vector MotionRoughness::variancesAfter(double time_step) const {
  RowInformation::Vector variances;
  variances << std::pow(0.5 * time_step * time_step, 2) * jerk(), time_step * time_step * jerk(),
      jerk().tail<3>();
  return variances;
}

Vector6d MotionRoughness::jerk() const {
  return withExcess(translation_.excess(), rotation_.excess());
}

Vector6d MotionRoughness::measuredJerk() const {
  return withExcess(translation_.measured(), rotation_.measured());
}

void MotionRoughness::compare(const Vector6d& difference, const Vector6d& variances) {
  inconsistency_ =
      memory_ * inconsistency_ + (1.0 - memory_) * difference.cwiseAbs2().cwiseQuotient(variances);
}

void MotionRoughness::update(std::span<const TimedPose> poses, const Vector6d& motion_stddev,
                             const MotionBlend& rows) {
  const Sensitivity by = sensitivityOf(poses, static_cast<int>(poses.size()) - 1);
  if (!by.known) return;
  const double square = by.velocity * by.velocity;
  const auto adapt = [&](int first, Excess& excess) {
    const auto mean = [&](const auto& of) { return of.template segment<3>(first).mean() / square; };
    excess.update(mean(rows.squared_difference),
                  mean(rows.row_variances) +
                      by.velocity_noise * by.velocity_noise * mean(motion_stddev.cwiseAbs2()) +
                      settings_.jerk_variance,
                  memory_);
  };
  adapt(0, translation_);
  adapt(3, rotation_);
}

}  // namespace cartvo::vo
