#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "vo_core/stereo_odometry.hpp"

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

}  // namespace cartvo::pipeline
