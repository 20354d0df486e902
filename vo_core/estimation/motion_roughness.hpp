#pragma once

#include <span>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {

/// How much the motion about an exposure differs from the parabola through the poses: by a jerk, that of a
/// smooth drive and what the rows of the last images have shown in addition.
class MotionRoughness {
 public:
  /// Variances of the difference between the motion about poses[index] and motionByPoses(). `motion_stddev`:
  /// of the motion from pair to pair.
  RowInformation::Vector variances(std::span<const TimedPose> poses, int index,
                                   const Vector6d& motion_stddev) const;

  /// Variances of the difference between the velocity and acceleration `time_step` seconds after an exposure
  /// and those extrapolated from it.
  RowInformation::Vector variancesAfter(double time_step) const;

  /// Updates with the variance of the velocity at the newest of the poses in excess of what variances()
  /// states.
  void update(std::span<const TimedPose> poses, const Vector6d& excess);

 private:
  Vector6d jerk() const;

  double translation_excess_ = 0.0;  ///< (m/s^3)^2
  double rotation_excess_ = 0.0;     ///< (rad/s^3)^2
};

}  // namespace cartvo::vo
