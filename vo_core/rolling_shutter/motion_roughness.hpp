#pragma once

#include <algorithm>
#include <span>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::vo {

/// How much the motion about an exposure differs from the parabola through the poses: by a jerk, that of a
/// smooth drive and what the rows of the last images have shown in addition.
class MotionRoughness {
 public:
  /// `correlated_pairs`: see SelfCalibrationSettings.
  MotionRoughness(const RollingShutterSettings& settings, double correlated_pairs)
      : settings_(settings), memory_(1.0 - 1.0 / correlated_pairs) {}

  /// Variances of the difference between the motion about poses[index] and motionByPoses(). `motion_stddev`:
  /// of the motion from pair to pair.
  RowInformation::Vector variances(std::span<const TimedPose> poses, int index,
                                   const Vector6d& motion_stddev) const {
    return variancesWith(jerk(), poses, index, motion_stddev);
  }
  /// The same for a covariance: with all that the rows have shown, even where it is too little to use them.
  RowInformation::Vector measuredVariances(std::span<const TimedPose> poses, int index,
                                           const Vector6d& motion_stddev) const {
    return variancesWith(measuredJerk(), poses, index, motion_stddev);
  }

  /// Variances of the difference between the velocity and acceleration `time_step` seconds after an exposure
  /// and those extrapolated from it.
  RowInformation::Vector variancesAfter(double time_step) const;

  /// Updates with what the rows show of the velocity at the newest of the poses.
  void update(std::span<const TimedPose> poses, const Vector6d& motion_stddev, const MotionBlend& rows);

  /// Updates with the difference between the motion between two poses as the motions about their exposures
  /// make it, and that of the poses themselves, and with the variances that it is said to have.
  void compare(const Vector6d& difference, const Vector6d& variances);
  /// Factor on the covariances of motions by rows, at least 1: the mean of the squared differences of the
  /// last pairs over their variances, along the axis where it is the largest.
  double varianceFactor() const { return std::max(1.0, inconsistency_.maxCoeff()); }

  /// Whether the motion is rougher than the parabola follows.
  bool isRough() const { return ratio() > MotionBlend::kSignificance; }
  /// Mean squared difference between the rows and the parabola, relative to what is expected of a smooth
  /// drive: the larger of translations and rotations.
  double ratio() const { return std::max(translation_.ratio(), rotation_.ratio()); }

 private:
  /// Mean of squared jerks, and of what was expected of them without an excess, of the last pairs.
  class Excess {
   public:
    void update(double squared, double expected, double memory);
    double ratio() const { return expected_ > 0.0 ? squared_ / expected_ : 0.0; }
    double excess() const;    ///< 0 unless it is significant
    double measured() const;  ///< the same, significant or not

   private:
    double squared_ = 0.0, expected_ = 0.0;
  };

  RowInformation::Vector variancesWith(const Vector6d& jerk, std::span<const TimedPose> poses, int index,
                                       const Vector6d& motion_stddev) const;
  Vector6d withExcess(double translation, double rotation) const;
  Vector6d jerk() const;
  Vector6d measuredJerk() const;
  RollingShutterSettings settings_;
  double memory_;       ///< weight of the previous roughness, per pair
  Excess translation_;  ///< (m/s^3)^2
  Excess rotation_;     ///< (rad/s^3)^2
  Vector6d inconsistency_ = Vector6d::Zero();
};

}  // namespace cartvo::vo
