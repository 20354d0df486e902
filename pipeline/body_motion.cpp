// Transforms poses, velocities and their covariances from the rectified left camera to the body. Equations:
// J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", 2018
// (arXiv:1812.01537), and T. Barfoot, "State Estimation for Robotics", 2017.

#include "pipeline/body_motion.hpp"

#include <cmath>
#include <limits>

#include "vo_core/rigid_motion.hpp"

namespace cartvo::pipeline {
namespace {

constexpr double kSmallAngle = 1e-5;  // rad; below it the series are exact to double precision

// V(theta), which maps the linear velocity to the translation (Solà, eq. 174).
Eigen::Matrix3d translationJacobian(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d W = vo::skew(rotation);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double squared = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / squared * W +
         (angle - std::sin(angle)) / (squared * angle) * W * W;
}

Eigen::Vector3d rotationLogarithm(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  const double scale = sine < kSmallAngle ? 2.0 / q.w() : 2.0 * std::atan2(sine, q.w()) / sine;
  return scale * q.vec();
}

// Inverse of the right Jacobian of SE(3), as a series in Bernoulli numbers (Barfoot, eq. 7.76b, with the sign
// of the right Jacobian). The next term is ad^6/30240: below 1e-9 for the 0.2 rad of a fast turn.
vo::Matrix6d inverseRightJacobian(const vo::Vector6d& twist) {
  vo::Matrix6d ad = vo::Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = vo::skew(twist.tail<3>());
  ad.topRightCorner<3, 3>() = vo::skew(twist.head<3>());
  const vo::Matrix6d squared = ad * ad;
  return vo::Matrix6d::Identity() + 0.5 * ad + squared / 12.0 - squared * squared / 720.0;
}

}  // namespace

vo::Vector6d scaleError(const Eigen::Isometry3d& pose, double scale_stddev) {
  vo::Vector6d error = vo::Vector6d::Zero();
  error.head<3>() = scale_stddev * (pose.linear().transpose() * pose.translation());
  return error;
}

vo::Vector6d logarithm(const Eigen::Isometry3d& motion) {
  const Eigen::Vector3d rotation = rotationLogarithm(motion.rotation());
  vo::Vector6d twist;
  twist << translationJacobian(rotation).inverse() * motion.translation(), rotation;
  return twist;
}

BodyMotion bodyMotion(const vo::OdometryEstimate& estimate, const Eigen::Isometry3d& T_body_rectified,
                      double scale_stddev) {
  const Eigen::Isometry3d T_rectified_body = T_body_rectified.inverse();
  const vo::Matrix6d Ad = vo::adjoint(T_body_rectified);

  BodyMotion motion;
  motion.T_world_body = T_body_rectified * estimate.T_world_camera * T_rectified_body;
  // T_body (T exp(x)) T_body^-1 = (T_body T T_body^-1) exp(Ad x): Solà, eq. 20.
  const vo::Vector6d pose_scale_error = Ad * scaleError(estimate.T_world_camera, scale_stddev);
  motion.pose_covariance =
      Ad * estimate.pose_covariance * Ad.transpose() + pose_scale_error * pose_scale_error.transpose();
  motion.T_previous_current = T_body_rectified * estimate.T_previous_current * T_rectified_body;

  if (!estimate.valid || !(estimate.time_step > 0.0)) {
    eraseTwist(motion);
    return motion;
  }
  const vo::Vector6d twist = logarithm(motion.T_previous_current);
  motion.velocity = twist.head<3>() / estimate.time_step;
  motion.angular_velocity = twist.tail<3>() / estimate.time_step;
  const vo::Matrix6d J = inverseRightJacobian(twist) * Ad / estimate.time_step;
  motion.twist_scale_error = J * scaleError(estimate.T_previous_current, scale_stddev);
  motion.twist_covariance = J * estimate.motion_covariance * J.transpose() +
                            motion.twist_scale_error * motion.twist_scale_error.transpose();
  return motion;
}

void setTwist(BodyMotion& motion, const vo::ExposureTwist& twist, const Eigen::Isometry3d& T_body_rectified,
              double scale_stddev) {
  // Velocity of the body's origin from that of the camera: v_body = R v - (R omega) x t, by the adjoint.
  const vo::Matrix6d Ad = vo::adjoint(T_body_rectified);
  const vo::Vector6d body = Ad * twist.value;
  motion.velocity = body.head<3>();
  motion.angular_velocity = body.tail<3>();
  vo::Vector6d scale_error = vo::Vector6d::Zero();
  scale_error.head<3>() = scale_stddev * twist.value.head<3>();
  motion.twist_scale_error = Ad * scale_error;
  motion.twist_covariance = Ad * twist.covariance * Ad.transpose() +
                            motion.twist_scale_error * motion.twist_scale_error.transpose();
  // Of the body's origin, which is fixed to the camera: a + alpha x l + omega x (omega x l); the first two by
  // the adjoint.
  const Eigen::Matrix3d& rotation = T_body_rectified.linear();
  const Eigen::Vector3d to_body = T_body_rectified.inverse().translation(), rate = twist.value.tail<3>();
  motion.acceleration = (Ad * twist.acceleration).head<3>() + rotation * rate.cross(rate.cross(to_body));
  const Eigen::Vector3d acceleration_scale_error = scale_stddev * (rotation * twist.acceleration.head<3>());
  motion.acceleration_covariance =
      (Ad * twist.acceleration_covariance * Ad.transpose()).topLeftCorner<3, 3>() +
      acceleration_scale_error * acceleration_scale_error.transpose();
}

void eraseTwist(BodyMotion& motion) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  motion.velocity.setConstant(kUnknown);
  motion.angular_velocity.setConstant(kUnknown);
  motion.twist_covariance.setConstant(kUnknown);
  motion.twist_scale_error.setConstant(kUnknown);
  motion.acceleration.setConstant(kUnknown);
  motion.acceleration_covariance.setConstant(kUnknown);
}

}  // namespace cartvo::pipeline
