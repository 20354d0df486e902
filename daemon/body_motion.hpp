#pragma once

#include <Eigen/Geometry>

#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// How the cart's body moved, told from one odometry estimate. Body axes (REP-103): x forward, y left, z up,
/// origin where the rig puts it. Covariances: order (x, y, z, rotation about x, y, z), SI units, as
/// perturbations on the right, that is in the axes of the current body.
struct BodyMotion {
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< world: the body at the first pair
  Matrix6d pose_covariance = Matrix6d::Zero();
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< of the body's origin, in body axes, m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< roll, pitch, yaw rate in body axes, rad/s
  Matrix6d twist_covariance = Matrix6d::Zero();
  /// What the offset's uncertainty has in it: its outer product is part of twist_covariance, and neighbouring
  /// velocities err together by it. NaN if there is no velocity.
  Vector6d twist_offset_error = Vector6d::Zero();
  /// The same of what the rig's scale has in it.
  Vector6d twist_scale_error = Vector6d::Zero();
};

/// Moves an estimate from the rectified left camera to the body that carries it. `T_body_rectified`:
/// rectified left camera axes to body axes. Velocity and rates are those of the constant twist that makes the
/// motion in its time step; an estimate that is not valid, or without a time step, has none: they are NaN.
/// `scale_deviation`: the rig's (Rig::scale_deviation), of which no image tells; it is added here to what the
/// estimate's covariances say of the images.
BodyMotion bodyMotion(const OdometryEstimate& estimate, const Eigen::Isometry3d& T_body_rectified,
                      double scale_deviation = 0.0);

/// The logarithm of SE(3): the twist (v, omega) which, held for one unit of time, makes `motion`. Rotations
/// below pi. (J. Solà et al., "A micro Lie theory for state estimation in robotics", 2018, eq. 173.)
Vector6d logarithm(const Eigen::Isometry3d& motion);

/// The exponential of SE(3), the inverse of `logarithm` (ibid., eq. 172).
Eigen::Isometry3d exponential(const Vector6d& twist);

}  // namespace cartvo
