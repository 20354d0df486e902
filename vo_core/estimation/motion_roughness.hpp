#pragma once

#include <span>

#include "vo_core/estimation/row_motion.hpp"
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {

/// How much the motion about an exposure differs from the parabola through the poses: by a jerk whose size is
/// estimated from the motions that the rows of the images have shown (expectation maximisation with a memory
/// of some pairs).
class MotionRoughness {
 public:
  /// Variances of the difference between the motion about poses[index] and motionByPoses(). `motion_stddev`:
  /// of the motion from pair to pair.
  RowInformation::Vector variances(std::span<const TimedPose> poses, int index,
                                   const Vector6d& motion_stddev) const;

  /// Variances of the difference between the velocity and acceleration `time_step` seconds after an exposure
  /// and those extrapolated from it.
  RowInformation::Vector variancesAfter(double time_step) const;

  /// Updates with the motion about the newest of the poses, which was expected to be `expected`.
  void update(std::span<const TimedPose> poses, const ExposureMotion& expected, const RowMotion& motion,
              const Vector6d& motion_stddev);

 private:
  double translation_jerk_ = 400.0;  ///< (m/s^3)^2
  double rotation_jerk_ = 100.0;     ///< (rad/s^3)^2
};

}  // namespace cartvo::vo
