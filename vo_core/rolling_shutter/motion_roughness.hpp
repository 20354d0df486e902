#pragma once

#include <algorithm>
#include <span>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::vo {

/// How much the motion about an exposure differs from the parabola through the poses: by a jerk, whose
/// variance along each axis is measured by the last poses.
class MotionRoughness {
 public:
  /// `correlated_pairs`: see SelfCalibrationSettings.
  MotionRoughness(const RollingShutterSettings& settings, double correlated_pairs)
      : settings_(settings),
        memory_(1.0 - 1.0 / correlated_pairs),
        jerk_squares_(Vector6d::Constant(settings.jerk_variance)) {}

  /// Variances of the difference between the motion about poses[index] and motionByPoses(). `motion_stddev`:
  /// of the motion from pair to pair.
  RowInformation::Vector variances(std::span<const TimedPose> poses, int index,
                                   const Vector6d& motion_stddev) const;

  /// Updates with the jerk between the last four poses.
  void update(std::span<const TimedPose> poses, const Vector6d& motion_stddev);

  /// Updates with the difference between the motion between two poses as the motions about their exposures
  /// make it, and that of the poses themselves, and with the variances that it is said to have.
  void compare(const Vector6d& difference, const Vector6d& variances);
  /// Factor on the covariances of motions by rows, at least 1: the mean of the squared differences of the
  /// last pairs over their variances, along the axis where it is the largest.
  double varianceFactor() const { return std::max(1.0, inconsistency_.maxCoeff()); }

 private:
  /// Variances of the jerk, (m/s^3)^2 and (rad/s^3)^2: the mean of the last pairs less what the noise of
  /// poses adds, but at least one standard deviation of that mean.
  Vector6d meanJerk() const;
  /// The same, or the newest if that is larger: a kerb is no smooth drive.
  Vector6d newestJerk() const { return meanJerk().cwiseMax(newest_jerk_); }
  RollingShutterSettings settings_;
  double memory_;  ///< weight of the previous pairs, per pair
  /// Mean squares of the third differences of the last poses, and of what the noise of the poses adds to
  /// them.
  Vector6d jerk_squares_, jerk_noise_ = Vector6d::Zero();
  Vector6d newest_jerk_ = Vector6d::Zero();  ///< square of the newest third difference less its noise
  Vector6d inconsistency_ = Vector6d::Zero();
};

}  // namespace cartvo::vo
