#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>

#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_odometry.hpp"

// Velocity at the exposure instant, from mean velocities over the frame periods: for estimates without a
// twist.

namespace cartvo::pipeline {

/// Motion of the cart's body, computed from one odometry estimate. Body axes (REP-103): x forward, y left,
/// z up; the rig file defines the origin. Covariances: order (x, y, z, rotation about x, y, z), SI units,
/// right perturbations, that is in the axes of the current body.
struct BodyMotion {
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< world: the body at the first pair
  vo::Matrix6d pose_covariance = vo::Matrix6d::Zero();
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< of the body's origin, in body axes, m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< roll, pitch, yaw rate in body axes, rad/s
  vo::Matrix6d twist_covariance = vo::Matrix6d::Zero();
  /// Error of the twist for a rig scale that is off by one standard deviation. Its outer product is part of
  /// twist_covariance; consecutive velocities share this error. NaN if there is no velocity.
  vo::Vector6d twist_scale_error = vo::Vector6d::Zero();
  /// m/s^2, of the body's origin, in body axes, without gravity; NaN if it is not estimated.
  Eigen::Vector3d acceleration = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Matrix3d acceleration_covariance =
      Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// Transforms an estimate from the rectified left camera to the body. `T_body_rectified`: rectified left
/// camera axes to body axes. Velocity and rates belong to the constant twist that produces the motion in its
/// time step; they are NaN if the estimate is invalid or has no time step. `scale_stddev`: relative standard
/// deviation of the rig's scale, which no image observes; its covariance is added to the estimate's.
BodyMotion bodyMotion(const vo::OdometryEstimate& estimate, const Eigen::Isometry3d& T_body_rectified,
                      double scale_stddev = 0.0);

/// Replaces velocity, rates and their covariance by those at the exposure, and sets the acceleration there.
/// `twist`: in the axes of the rectified left camera. The uncertainty of the angular rate is no part of the
/// acceleration's: 0.01 rad/s at 1 rad/s and 2 m from the camera to the body are 0.04 m/s^2.
void setTwist(BodyMotion& motion, const vo::ExposureTwist& twist, const Eigen::Isometry3d& T_body_rectified,
              double scale_stddev);

/// Sets velocity, rates, acceleration and their covariances to NaN: not known, or not well enough.
void eraseTwist(BodyMotion& motion);

/// Error of a pose or motion for a scale that is off by one standard deviation: all distances are too long by
/// the same fraction. Right perturbation.
vo::Vector6d scaleError(const Eigen::Isometry3d& pose, double scale_stddev);

/// Logarithm of SE(3): the twist (v, omega) which, applied for one unit of time, produces `motion`. Rotations
/// below pi. (J. Solà et al., "A micro Lie theory for state estimation in robotics", 2018, eq. 173.)
vo::Vector6d logarithm(const Eigen::Isometry3d& motion);

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
