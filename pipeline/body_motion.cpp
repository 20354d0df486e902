// Transforms poses, velocities and their covariances from the rectified left camera to the body. Equations:
// J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", 2018
// (arXiv:1812.01537), and T. Barfoot, "State Estimation for Robotics", 2017.
#include "pipeline/body_motion.hpp"

#include <algorithm>
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

constexpr double kForgettingFactor = 0.9;     // per pair
constexpr double kInitialAcceleration = 2.5;  // m/s^2 and rad/s^2, prior standard deviation: a lively cart
constexpr double kInitialJerk = 20.0;         // m/s^3 and rad/s^3, the same

/// Second moment without the variance of the noise, axis by axis; correlations are kept.
vo::Matrix6d withoutNoise(const vo::Matrix6d& moment, const vo::Vector6d& noise) {
  const vo::Vector6d part =
      (1.0 - noise.array() / moment.diagonal().array().max(1e-12)).max(0.0).sqrt().matrix();
  return part.asDiagonal() * moment * part.asDiagonal();
}

/// The prior counts as the first of the values.
void updateMoment(Moment& moment, const vo::Vector6d& value) {
  moment.values += 1.0;
  const double weight = std::max(1.0 - kForgettingFactor, 1.0 / moment.values);
  moment.mean += weight * (value * value.transpose() - moment.mean);
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

VelocityAtExposure::VelocityAtExposure()
    : acceleration_moment_{vo::Matrix6d::Identity() * kInitialAcceleration * kInitialAcceleration},
      jerk_moment_{vo::Matrix6d::Identity() * kInitialJerk * kInitialJerk} {}

Twist VelocityAtExposure::extrapolate(const Twist& mean, double time_step) {
  // Variance of a pose's error over h^2; the mean contains it twice.
  const vo::Vector6d noise = 0.5 * mean.covariance.diagonal();
  std::optional<vo::Vector6d> slope;
  double between = time_step;  // from the middle of the last time step to that of this one
  if (last_) {
    between = 0.5 * (time_step + last_->time_step);
    slope = (mean.value - last_->value) / between;
    updateMoment(acceleration_moment_, *slope);
    if (last_slope_) updateMoment(jerk_moment_, (*slope - *last_slope_) / between);
  }
  const double ahead = 0.5 * time_step;  // from the middle of the time step to the exposure
  const vo::Vector6d slope_noise = 6.0 * noise / (between * between);
  const vo::Vector6d jerk_noise = 20.0 * noise / std::pow(between, 4);
  const Eigen::Array<double, 6, 1> ratio =
      acceleration_moment_.mean.diagonal().array() / slope_noise.array().max(1e-12);
  vo::Vector6d part = (1.0 - 2.0 / ratio.max(2.0)).matrix();
  if (!slope) part.setZero();

  Twist now;
  now.value = mean.value;
  if (slope) now.value += ahead * part.cwiseProduct(*slope);
  const Eigen::Array<double, 6, 1> a = part.array();
  const vo::Vector6d growth =
      (0.5 * ((1.0 + 0.5 * a).square() + (1.0 + a).square() + 0.25 * a.square())).sqrt().matrix();
  const vo::Vector6d not_extrapolated = ahead * (1.0 - a).matrix();
  // With a constant jerk j, linear extrapolation over the time step h has the error j h^2 / 3.
  const vo::Vector6d jerk_gain = (time_step * time_step / 3.0) * part;
  now.covariance = growth.asDiagonal() * mean.covariance * growth.asDiagonal();
  now.covariance += not_extrapolated.asDiagonal() * withoutNoise(acceleration_moment_.mean, slope_noise) *
                    not_extrapolated.asDiagonal();
  now.covariance +=
      jerk_gain.asDiagonal() * withoutNoise(jerk_moment_.mean, jerk_noise) * jerk_gain.asDiagonal();

  last_ = Mean{mean.value, time_step};
  last_slope_ = slope;
  return now;
}

void VelocityAtExposure::setStandstill(double time_step) {
  last_ = Mean{vo::Vector6d::Zero(), time_step};
  last_slope_.reset();
}

void VelocityAtExposure::reset() {
  last_.reset();
  last_slope_.reset();
}

}  // namespace cartvo::pipeline
