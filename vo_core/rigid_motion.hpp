#pragma once

#include <Eigen/Geometry>

// Rigid motions as 6-vectors, and the propagation of their covariances.

namespace cartvo::vo {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The matrix of the cross product: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& vector);

/// Converts a motion to a vector (x, y, z, rotation vector; m and rad) and back. Translation and rotation are
/// separate, not along a screw: for the perturbations and steps used here both agree to first order.
Eigen::Isometry3d motionFromVector(const Vector6d& vector);
Vector6d vectorFromMotion(const Eigen::Isometry3d& motion);

/// The adjoint: T * motionFromVector(v) = motionFromVector(adjoint(T) * v) * T to first order, in the order
/// (x, y, z, rotation).
Matrix6d adjoint(const Eigen::Isometry3d& T);

/// The same motion with an exactly orthonormal rotation. Isometry3d::inverse() transposes the rotation; in a
/// chain of poses that are multiplied and inverted in turn, a rounding error would double at each step.
Eigen::Isometry3d orthonormalised(const Eigen::Isometry3d& motion);

/// The covariance of pose * motion, both given as perturbations on the right and independent.
Matrix6d composedCovariance(const Matrix6d& pose_covariance, const Eigen::Isometry3d& motion,
                            const Matrix6d& motion_covariance);

}  // namespace cartvo::vo
