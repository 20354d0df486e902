#pragma once

#include <optional>

#include "vo_core/rigid_motion.hpp"

// Velocity at the exposure instant, from mean velocities over the frame periods: for estimates without a
// twist.

namespace cartvo::pipeline {

/// A twist in body axes: velocity m/s, angular velocity rad/s.
struct Twist {
  vo::Vector6d value = vo::Vector6d::Zero();
  vo::Matrix6d covariance = vo::Matrix6d::Zero();
};

/// Exponentially weighted mean of outer products.
struct Moment {
  vo::Matrix6d mean;    ///< at first a prior
  double values = 1.0;  ///< in it, with the prior
};

/// Velocity at the exposure of a pair. A motion yields the mean velocity over the time step, which lags by
/// half a frame period: 3 cm/s at 1 m/s^2 and 18 fps. Extrapolation by half the change since the previous
/// mean removes the lag but adds noise; in each axis it is scaled by the factor a that minimises the expected
/// squared error:
///
///   v = m1 + a g (m1 - m0),   g = h1 / (h1 + h0),   a = max(0, 1 - 2 / s)
///
/// with the means m0, m1 over the time steps h0, h1, and s the ratio of the mean square of such changes to
/// the mean square of their noise. (Noise model: each pose has the error e, so m1 = v + (e1 - e0) / h. Then
/// the variance of the error over var e / h^2 is (1 + a/2)^2 + (1 + a)^2 + a^2/4 + (1 - a)^2 (s - 1) 6/4; a
/// is the zero of its derivative.)
///
/// The covariance is the sum of the noise, the change that is not extrapolated, and the error of linear
/// extrapolation; the last two are computed from the accelerations and jerks observed so far. Not
/// thread-safe.
class VelocityAtExposure {
 public:
  VelocityAtExposure();

  /// Extrapolates `mean`, the mean twist over the last `time_step` (s, positive), to the exposure.
  Twist extrapolate(const Twist& mean, double time_step);

  /// Sets the last mean to zero after a zero-velocity update. It does not update the observed accelerations,
  /// because the zero velocity is an assumption, not a measurement.
  void setStandstill(double time_step);

  /// Discards the last mean: the next motion is not consecutive.
  void reset();

 private:
  struct Mean {
    vo::Vector6d value = vo::Vector6d::Zero();
    double time_step = 0.0;
  };

  Moment acceleration_moment_, jerk_moment_;
  std::optional<Mean> last_;
  std::optional<vo::Vector6d> last_slope_;  ///< change of the mean per second
};

}  // namespace cartvo::pipeline
