// Measurement of the jerk by the last poses.
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

RowInformation::Vector MotionRoughness::variances(std::span<const TimedPose> poses, int index,
                                                  const Vector6d& motion_stddev) const {
  RowInformation::Vector variances;
  const Vector6d jerk = index + 1 == static_cast<int>(poses.size()) ? newestJerk() : meanJerk();
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

void MotionRoughness::compare(const Vector6d& difference, const Vector6d& variances) {
  inconsistency_ =
      memory_ * inconsistency_ + (1.0 - memory_) * difference.cwiseAbs2().cwiseQuotient(variances);
}

Vector6d MotionRoughness::meanJerk() const {
  const double stddev = std::sqrt(2.0 * (1.0 - memory_) / (1.0 + memory_));  // of the mean square, relative
  return (jerk_squares_ - jerk_noise_).cwiseMax(stddev * jerk_squares_);
}

/// The third difference of the last four poses. With independent errors of poses, each half the variance of a
/// motion, its variance is 20 times theirs.
void MotionRoughness::update(std::span<const TimedPose> poses, const Vector6d& motion_stddev) {
  constexpr std::size_t kPoses = 4;
  if (poses.size() < kPoses) return;
  const std::span<const TimedPose> last = poses.last(kPoses);
  const auto velocity = [&](std::size_t to) -> Vector6d {
    return vectorFromMotion(last[to - 1].T_world_camera.inverse() * last[to].T_world_camera) /
           (last[to].time - last[to - 1].time);
  };
  const double before = 0.5 * (last[2].time - last[0].time), after = 0.5 * (last[3].time - last[1].time);
  const double between = (last[3].time - last[0].time) / 3.0;
  const Vector6d jerk =
      ((velocity(3) - velocity(2)) / after - (velocity(2) - velocity(1)) / before) / between;
  if (!jerk.allFinite()) return;
  const Vector6d noise = 10.0 / std::pow(before * between * after, 2) * motion_stddev.cwiseAbs2();
  newest_jerk_ = jerk.cwiseAbs2() - noise;
  jerk_squares_ = memory_ * jerk_squares_ + (1.0 - memory_) * jerk.cwiseAbs2();
  jerk_noise_ = memory_ * jerk_noise_ + (1.0 - memory_) * noise;
}

}  // namespace cartvo::vo
