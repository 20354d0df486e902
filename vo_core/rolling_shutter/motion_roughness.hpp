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

  /// Updates with what the rows show of the velocity at the newest of the poses.
  void update(std::span<const TimedPose> poses, const Vector6d& motion_stddev, const MotionBlend& rows);

  /// Whether the motion is rougher than the parabola follows.
  bool isRough() const { return exceeds(MotionBlend::kSignificance); }
  /// Whether the rows show no more than what is expected of a smooth drive, not even by chance.
  bool isSmooth() const { return !exceeds(1.0); }

 private:
  /// Mean of squared jerks, and of what was expected of them without an excess, of the last pairs.
  class Excess {
   public:
    void update(double squared, double expected);
    bool exceeds(double significance) const { return squared_ > significance * expected_; }
    double excess() const;  ///< 0 unless it is significant

   private:
    double squared_ = 0.0, expected_ = 0.0;
  };

  Vector6d jerk() const;
  bool exceeds(double significance) const {
    return translation_.exceeds(significance) || rotation_.exceeds(significance);
  }

  Excess translation_;  ///< (m/s^3)^2
  Excess rotation_;     ///< (rad/s^3)^2
};

}  // namespace cartvo::vo
