// Body motion from the camera's motion, compared with closed forms and numeric derivatives.
#include "pipeline/body_motion.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include <gtest/gtest.h>

#include "calib/model/rig.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::pipeline {
namespace {

constexpr double kPi = 3.14159265358979323846;

vo::Vector6d vector6(double x, double y, double z, double rx, double ry, double rz) {
  vo::Vector6d vector;
  vector << x, y, z, rx, ry, rz;
  return vector;
}

/// Exponential of SE(3), the inverse of `logarithm`.
Eigen::Isometry3d exponential(const vo::Vector6d& twist) {
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() = vo::skew(twist.tail<3>());
  generator.topRightCorner<3, 1>() = twist.head<3>();
  return Eigen::Isometry3d(Eigen::Matrix4d(generator.exp()));
}

/// Mount of a camera 1 m ahead of the body's origin, 0.5 m to the left and 2 m up, tilted down.
Eigen::Isometry3d tiltedMount() {
  Eigen::Isometry3d mount = calib::forwardLookingMount();
  mount.translation() = Eigen::Vector3d(1.0, 0.5, 2.0);
  mount.rotate(Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()));
  return mount;
}

/// Odometry estimate for a body that moved by `T_body` in `time_step` s.
vo::OdometryEstimate estimateOf(const Eigen::Isometry3d& T_body, const Eigen::Isometry3d& mount,
                                double time_step) {
  vo::OdometryEstimate estimate;
  estimate.valid = true;
  estimate.time_step = time_step;
  estimate.T_previous_current = mount.inverse() * T_body * mount;
  estimate.T_world_camera = estimate.T_previous_current;
  return estimate;
}

TEST(BodyMotion, StraightMotionGivesVelocityAlongX) {
  const Eigen::Isometry3d mount = tiltedMount();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(0.25, 0.0, 0.0);
  const BodyMotion motion = bodyMotion(estimateOf(T, mount, 0.05), mount);
  EXPECT_TRUE(motion.velocity.isApprox(Eigen::Vector3d(5.0, 0.0, 0.0), 1e-12));
  EXPECT_LT(motion.angular_velocity.norm(), 1e-12);
  EXPECT_TRUE(motion.T_world_body.isApprox(T, 1e-12));
}

TEST(BodyMotion, TurningInPlaceMovesCameraButNotBodyOrigin) {
  const Eigen::Isometry3d mount = tiltedMount();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  const vo::OdometryEstimate estimate = estimateOf(T, mount, 0.1);
  EXPECT_GT(estimate.T_previous_current.translation().norm(), 0.1);
  const BodyMotion motion = bodyMotion(estimate, mount);
  EXPECT_LT(motion.velocity.norm(), 1e-12);
  EXPECT_TRUE(motion.angular_velocity.isApprox(Eigen::Vector3d(0.0, 0.0, 1.0), 1e-12));
}

TEST(BodyMotion, CircleGivesConstantSpeedAndYawRateForAnyTimeStep) {
  // On a circle of 8 m at 4 m/s the yaw rate is 0.5 rad/s to the left; the chord is shorter than the path.
  const Eigen::Isometry3d mount = tiltedMount();
  for (const double time_step : {0.01, 0.0556, 0.5, 2.0}) {
    const double angle = 0.5 * time_step;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d(8.0 * std::sin(angle), 8.0 * (1.0 - std::cos(angle)), 0.0);
    T.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    const BodyMotion motion = bodyMotion(estimateOf(T, mount, time_step), mount);
    EXPECT_TRUE(motion.velocity.isApprox(Eigen::Vector3d(4.0, 0.0, 0.0), 1e-9))
        << motion.velocity.transpose();
    EXPECT_TRUE(motion.angular_velocity.isApprox(Eigen::Vector3d(0.0, 0.0, 0.5), 1e-9));
  }
}

TEST(BodyMotion, InvalidEstimateHasNoVelocity) {
  vo::OdometryEstimate estimate = estimateOf(Eigen::Isometry3d::Identity(), tiltedMount(), 0.05);
  estimate.valid = false;
  const BodyMotion invalid = bodyMotion(estimate, tiltedMount());
  EXPECT_TRUE(std::isnan(invalid.velocity.x()));
  EXPECT_TRUE(std::isnan(invalid.twist_covariance(0, 0)));
  estimate.valid = true;
  estimate.time_step = 0.0;
  EXPECT_TRUE(std::isnan(bodyMotion(estimate, tiltedMount()).angular_velocity.z()));
}

TEST(BodyMotion, LogarithmInvertsExponentialForAnglesBelowPi) {
  for (const double angle : {0.0, 1e-9, 1e-6, 1e-3, 0.5, 2.0, kPi - 1e-3}) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
    vo::Vector6d twist;
    twist << 0.3, -1.2, 4.0, angle * axis;
    EXPECT_TRUE(logarithm(exponential(twist)).isApprox(twist, 1e-8)) << angle;
  }
}

TEST(BodyMotion, PoseCovarianceMatchesSampledPoses) {
  // Cov[log(T_mean^-1 T)] of sampled camera poses, compared with the adjoint's.
  const Eigen::Isometry3d mount = tiltedMount();
  vo::OdometryEstimate estimate =
      estimateOf(exponential(vector6(0.4, 0.1, 0.0, 0.02, -0.03, 0.2)), mount, 0.1);
  const vo::Vector6d stddevs = vector6(1e-3, 2e-3, 3e-3, 1e-3, 5e-4, 2e-3);
  estimate.pose_covariance = stddevs.cwiseAbs2().asDiagonal();
  const BodyMotion motion = bodyMotion(estimate, mount);

  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  vo::Matrix6d sampled = vo::Matrix6d::Zero();
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    vo::Vector6d perturbation;
    for (int row = 0; row < 6; ++row)
      perturbation(row) = stddevs(row) * normal(random);
    const Eigen::Isometry3d perturbed =
        mount * estimate.T_world_camera * exponential(perturbation) * mount.inverse();
    const vo::Vector6d difference = logarithm(motion.T_world_body.inverse() * perturbed);
    sampled += difference * difference.transpose() / kSamples;
  }
  EXPECT_LT((sampled - motion.pose_covariance).norm(), 0.03 * motion.pose_covariance.norm());
}

TEST(BodyMotion, ScaleErrorLengthensAllDistances) {
  const Eigen::Isometry3d mount = tiltedMount();
  constexpr double kScale = 1e-4, kTimeStep = 0.1;
  vo::OdometryEstimate estimate =
      estimateOf(exponential(vector6(0.5, 0.1, 0.0, 0.02, -0.03, 0.2)), mount, kTimeStep);
  estimate.T_world_camera = mount.inverse() * exponential(vector6(30.0, 10.0, 1.0, 0.1, 0.0, 2.0)) * mount;
  vo::OdometryEstimate longer = estimate;
  for (Eigen::Isometry3d* const pose : {&longer.T_previous_current, &longer.T_world_camera})
    pose->translation() *= 1.0 + kScale;
  const BodyMotion motion = bodyMotion(estimate, mount, kScale), of_longer = bodyMotion(longer, mount);

  const vo::Vector6d pose_error = logarithm(motion.T_world_body.inverse() * of_longer.T_world_body);
  EXPECT_GT(pose_error.norm(), 2e-3) << "1e-4 of 30 m";
  EXPECT_TRUE(motion.pose_covariance.isApprox(pose_error * pose_error.transpose(), 1e-6));
  vo::Vector6d twist_error;
  twist_error << of_longer.velocity - motion.velocity, of_longer.angular_velocity - motion.angular_velocity;
  EXPECT_TRUE(motion.twist_scale_error.isApprox(twist_error, 1e-3)) << motion.twist_scale_error.transpose();
  EXPECT_TRUE(motion.twist_covariance.isApprox(twist_error * twist_error.transpose(), 2e-3));
}

TEST(BodyMotion, TwistCovarianceMatchesNumericJacobian) {
  const Eigen::Isometry3d mount = tiltedMount();
  const double time_step = 0.0556;
  vo::OdometryEstimate estimate =
      estimateOf(exponential(vector6(0.3, 0.02, -0.01, 0.02, 0.05, -0.15)), mount, time_step);
  vo::Matrix6d root = vo::Matrix6d::Zero();
  for (int i = 0; i < 36; ++i)
    root(i / 6, i % 6) = 1e-3 * std::cos(1.7 * i);
  estimate.motion_covariance = root * root.transpose();

  vo::Matrix6d J;
  const double step = 1e-6;
  for (int column = 0; column < 6; ++column) {
    const vo::Vector6d perturbation = step * vo::Vector6d::Unit(column);
    const auto twist = [&](double sign) {
      vo::OdometryEstimate perturbed = estimate;
      perturbed.T_previous_current = estimate.T_previous_current * exponential(sign * perturbation);
      const BodyMotion motion = bodyMotion(perturbed, mount);
      vo::Vector6d result;
      result << motion.velocity, motion.angular_velocity;
      return result;
    };
    J.col(column) = (twist(1.0) - twist(-1.0)) / (2.0 * step);
  }
  const vo::Matrix6d expected = J * estimate.motion_covariance * J.transpose();
  EXPECT_LT((bodyMotion(estimate, mount).twist_covariance - expected).norm(), 1e-6 * expected.norm());
}

TEST(BodyMotion, MovesATwistToTheBodyOrigin) {
  vo::ExposureTwist twist;
  twist.value = vector6(0.1, -0.2, 3.0, 0.05, -0.4, 0.02);
  twist.covariance = 1e-4 * vo::Matrix6d::Identity();
  const Eigen::Isometry3d mount = tiltedMount();
  BodyMotion motion;
  setTwist(motion, twist, mount, 0.01);
  const Eigen::Vector3d rates = mount.linear() * twist.value.tail<3>();
  // The camera's velocity is that of the body's origin plus rates x lever arm.
  const Eigen::Vector3d camera = motion.velocity + rates.cross(mount.translation());
  EXPECT_LT((motion.angular_velocity - rates).norm(), 1e-12);
  EXPECT_LT((camera - mount.linear() * twist.value.head<3>()).norm(), 1e-12);
  EXPECT_NEAR(motion.twist_scale_error.norm(), 0.01 * twist.value.head<3>().norm(), 1e-12);
  const Eigen::Vector3d forward = mount.linear() * Eigen::Vector3d(0.1, -0.2, 3.0);
  EXPECT_NEAR(motion.twist_covariance(5, 5), 1e-4, 1e-12);
  EXPECT_GT(motion.twist_covariance(0, 0), 1e-4 + 0.99e-4 * forward.x() * forward.x());
}

/// A body that turns ever faster on a spiral: the camera's acceleration by differences of its path.
TEST(BodyMotion, MovesAnAccelerationToTheBodyOrigin) {
  const Eigen::Isometry3d mount = tiltedMount();
  const auto body_at = [](double t) {
    Eigen::Isometry3d body(
        Eigen::AngleAxisd(0.8 * t + 0.6 * t * t, Eigen::Vector3d(0.1, -0.2, 1.0).normalized()));
    body.translation() = Eigen::Vector3d(3.0 * t + t * t, 0.5 * t * t, 0.2 * t);
    return body;
  };
  constexpr double kStep = 1e-4, kTime = 0.3;
  const auto camera_at = [&](double t) { return body_at(kTime + t) * mount; };
  const auto acceleration_of = [&](const auto& path) {
    const Eigen::Vector3d second =
        (path(kStep).translation() - 2.0 * path(0.0).translation() + path(-kStep).translation()) /
        (kStep * kStep);
    return Eigen::Vector3d(path(0.0).linear().transpose() * second);
  };
  const auto rate_at = [&](double t) {
    return Eigen::Vector3d(logarithm(camera_at(t - kStep).inverse() * camera_at(t + kStep)).tail<3>() /
                           (2.0 * kStep));
  };
  vo::ExposureTwist twist;
  twist.value.tail<3>() = rate_at(0.0);
  twist.acceleration << acceleration_of(camera_at), (rate_at(kStep) - rate_at(-kStep)) / (2.0 * kStep);
  twist.acceleration_covariance.diagonal() << 0.01, 0.01, 0.01, 0.04, 0.04, 0.04;
  BodyMotion motion;
  setTwist(motion, twist, mount, 0.0);
  const Eigen::Vector3d truth = acceleration_of([&](double t) { return body_at(kTime + t); });
  EXPECT_LT((motion.acceleration - truth).norm(), 1e-4) << motion.acceleration.transpose();
  // About the vertical axis, the lever arm is 1 m forward and 0.5 m to the left.
  EXPECT_NEAR(motion.acceleration_covariance.trace(), 3 * 0.01 + 2 * 0.04 * (1.0 + 0.25 + 4.0), 1e-9);
}

constexpr double kStep = 1.0 / 18.0;  // s
constexpr double kPoseError = 2e-4;   // m and rad

/// Position and velocity along each axis over time.
struct Drive {
  std::function<double(double)> position;
  std::function<double(double)> velocity;
  double step = kStep;
};

struct Outcome {
  double nees = 0.0;                // per dimension, mean
  double mean_square = 0.0;         // of the extrapolated velocities' errors
  double mean_square_lagged = 0.0;  // of the mean velocities' errors
};

/// Measures poses at the end of each step with independent errors and extrapolates the mean velocities.
Outcome evaluate(const Drive& drive, int pairs, double pose_error) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, pose_error);
  const auto errors = [&] {
    vo::Vector6d e;
    for (int i = 0; i < 6; ++i)
      e[i] = normal(random);
    return e;
  };
  VelocityAtExposure velocity;
  Outcome outcome;
  vo::Vector6d before = errors();
  const int warm_up = 30;
  for (int i = 1; i <= pairs; ++i) {
    const double time = i * drive.step;
    const vo::Vector6d after = errors();
    Twist mean;
    mean.value =
        (vo::Vector6d::Constant(drive.position(time) - drive.position(time - drive.step)) + after - before) /
        drive.step;
    mean.covariance = vo::Matrix6d::Identity() * 2.0 * std::pow(std::max(pose_error, 1e-7) / drive.step, 2);
    before = after;
    const Twist now = velocity.extrapolate(mean, drive.step);
    if (i <= warm_up) continue;
    const vo::Vector6d truth = vo::Vector6d::Constant(drive.velocity(time));
    const vo::Vector6d error = now.value - truth;
    outcome.nees += error.dot(now.covariance.ldlt().solve(error)) / 6.0 / (pairs - warm_up);
    outcome.mean_square += error.squaredNorm() / 6.0 / (pairs - warm_up);
    outcome.mean_square_lagged += (mean.value - truth).squaredNorm() / 6.0 / (pairs - warm_up);
  }
  return outcome;
}

Drive swinging(double amplitude, double frequency) {
  const double w = 2.0 * M_PI * frequency;
  return {[=](double t) { return -amplitude / w * std::cos(w * t); },
          [=](double t) { return amplitude * std::sin(w * t); }};
}

TEST(VelocityAtExposure, IsExactForConstantAcceleration) {
  const Drive drive{[](double t) { return 0.5 * 2.0 * t * t; }, [](double t) { return 2.0 * t; }};
  const Outcome outcome = evaluate(drive, 60, 0.0);
  EXPECT_LT(std::sqrt(outcome.mean_square), 1e-3);
  EXPECT_GT(std::sqrt(outcome.mean_square_lagged), 0.05);  // m/s: half a time step of 2 m/s^2
}

TEST(VelocityAtExposure, IsNoNoisierThanMeanAtConstantVelocity) {
  const Drive drive{[](double t) { return 3.0 * t; }, [](double) { return 3.0; }};
  const Outcome outcome = evaluate(drive, 2000, kPoseError);
  EXPECT_LT(outcome.mean_square, 1.1 * outcome.mean_square_lagged);
  EXPECT_GT(outcome.nees, 0.7);
  EXPECT_LT(outcome.nees, 1.1);
}

TEST(VelocityAtExposure, ReducesLagOfSwingingCartWithConsistentCovariance) {
  for (const double frequency : {0.5, 1.0, 2.0}) {  // Hz, as a cart pitches and rolls
    const Outcome outcome = evaluate(swinging(0.3, frequency), 2000, kPoseError);
    EXPECT_LT(outcome.mean_square, 0.5 * outcome.mean_square_lagged) << frequency;
    EXPECT_GT(outcome.nees, 0.4) << frequency;
    EXPECT_LT(outcome.nees, 1.5) << frequency;
  }
}

TEST(VelocityAtExposure, IsMeanWithLargeCovarianceAfterReset) {
  VelocityAtExposure velocity;
  Twist mean;
  mean.covariance = vo::Matrix6d::Identity() * 1e-6;
  for (int i = 0; i < 10; ++i) {
    mean.value.setConstant(0.1 * i);
    velocity.extrapolate(mean, kStep);
  }
  velocity.reset();
  mean.value.setConstant(5.0);
  const Twist now = velocity.extrapolate(mean, kStep);
  EXPECT_EQ(now.value, mean.value);
  EXPECT_GT(now.covariance(0, 0), 10.0 * mean.covariance(0, 0));
}

TEST(VelocityAtExposure, ExtrapolatesFromZeroAfterStandstill) {
  VelocityAtExposure velocity;
  Twist mean;
  mean.covariance = vo::Matrix6d::Identity() * 1e-6;
  velocity.extrapolate(mean, kStep);
  velocity.setStandstill(kStep);
  mean.value.setConstant(0.05);
  EXPECT_GT(velocity.extrapolate(mean, kStep).value[0], 0.06);
}

}  // namespace

}  // namespace cartvo::pipeline
