// Calculus of rigid motions; see T. Barfoot, "State Estimation for Robotics", chapter 7.
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

Eigen::Matrix3d skew(const Eigen::Vector3d& vector) {
  Eigen::Matrix3d matrix;
  matrix << 0, -vector.z(), vector.y(), vector.z(), 0, -vector.x(), -vector.y(), vector.x(), 0;
  return matrix;
}

Eigen::Isometry3d motionFromVector(const Vector6d& vector) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d rotation = vector.tail<3>();
  const double angle = rotation.norm();
  if (angle > 1e-12) motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  motion.translation() = vector.head<3>();
  return motion;
}

Vector6d vectorFromMotion(const Eigen::Isometry3d& motion) {
  const Eigen::AngleAxisd rotation(motion.linear());
  Vector6d vector;
  vector << motion.translation(), rotation.angle() * rotation.axis();
  return vector;
}

Matrix6d adjoint(const Eigen::Isometry3d& T) {
  Matrix6d matrix = Matrix6d::Zero();
  matrix.topLeftCorner<3, 3>() = T.linear();
  matrix.topRightCorner<3, 3>() = skew(T.translation()) * T.linear();
  matrix.bottomRightCorner<3, 3>() = T.linear();
  return matrix;
}

Eigen::Isometry3d orthonormalised(const Eigen::Isometry3d& motion) {
  Eigen::Isometry3d result = motion;
  result.linear() = Eigen::Quaterniond(motion.linear()).normalized().toRotationMatrix();
  return result;
}

Matrix6d composedCovariance(const Matrix6d& pose_covariance, const Eigen::Isometry3d& motion,
                            const Matrix6d& motion_covariance) {
  const Matrix6d carried = adjoint(motion.inverse());
  return carried * pose_covariance * carried.transpose() + motion_covariance;
}

}  // namespace cartvo::vo
