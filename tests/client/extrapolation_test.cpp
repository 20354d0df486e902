// Tests of extrapolation: poses against analytic and stepwise integrated motions of constant twist,
// covariances against numeric derivatives.

#include <Eigen/Geometry>
#include <cmath>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"

namespace cartvo::client {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::int64_t kNow = test::kMessageUtime;
constexpr MotionNoise kNoNoise{0.0, 0.0};

Eigen::Isometry3d poseOf(const std::array<double, 3>& position, const std::array<double, 4>& q) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(position[0], position[1], position[2]);
  return pose;
}

Eigen::Isometry3d poseOf(const Motion& motion) {
  return poseOf(motion.position, motion.orientation);
}

/// A small motion, exact to first order: enough for numeric derivatives and for many small steps.
Eigen::Isometry3d smallMotion(const Vector6& motion) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d angle = motion.tail<3>();
  if (angle.norm() > 0.0)
    pose.linear() = Eigen::AngleAxisd(angle.norm(), angle.normalized()).toRotationMatrix();
  pose.translation() = motion.head<3>() + 0.5 * angle.cross(motion.head<3>());
  return pose;
}

Vector6 toSmallMotion(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd rotation(pose.linear());
  Vector6 motion;
  motion << pose.translation(), rotation.angle() * rotation.axis();
  return motion;
}

void setPose(odometry_t& message, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  Eigen::Map<Eigen::Vector3d>(message.position_world_body) = pose.translation();
  Eigen::Map<Eigen::Vector4d>(message.orientation_world_body) << q.w(), q.x(), q.y(), q.z();
}

/// A cart somewhere, turning about all axes.
odometry_t tumblingCart() {
  odometry_t message = test::validMessage();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, -0.4, 0.9).normalized()));
  pose.pretranslate(Eigen::Vector3d(12.0, -3.0, 0.5));
  setPose(message, pose);
  Eigen::Map<Eigen::Vector3d>(message.velocity_body) << 3.0, 0.2, -0.4;
  Eigen::Map<Eigen::Vector3d>(message.angular_velocity_body) << 0.5, -0.8, 1.2;
  return message;
}

Matrix6 someCovariance(double scale) {
  Matrix6 root;
  for (int i = 0; i < 36; ++i)
    root(i / 6, i % 6) = std::sin(1.0 + 1.7 * i);
  return scale * (root * root.transpose() + Matrix6::Identity());
}

void setCovariances(odometry_t& message, const Matrix6& pose, const Matrix6& twist) {
  Eigen::Map<Matrix6>(message.pose_covariance_body) = pose;
  Eigen::Map<Matrix6>(message.twist_covariance_body) = twist;
}

TEST(Extrapolation, DrivesACircle) {
  odometry_t message = test::validMessage();
  message.angular_velocity_body[2] = 0.6;
  const Motion motion = extrapolate(message, kNow + 250'000);
  const double radius = 3.0 / 0.6, angle = 0.6 * 0.25;
  EXPECT_NEAR(motion.position[0], radius * std::sin(angle), 1e-12);
  EXPECT_NEAR(motion.position[1], radius * (1.0 - std::cos(angle)), 1e-12);
  EXPECT_NEAR(motion.orientation[0], std::cos(angle / 2), 1e-12);
  EXPECT_NEAR(motion.orientation[3], std::sin(angle / 2), 1e-12);
  EXPECT_EQ(motion.utime, kNow + 250'000);
  EXPECT_DOUBLE_EQ(motion.velocity[0], 3.0) << "constant in body axes";
}

TEST(Extrapolation, DrivesAhead) {
  odometry_t message = test::validMessage();
  setPose(message, Eigen::Isometry3d(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())));
  const Motion motion = extrapolate(message, kNow + 100'000);
  EXPECT_NEAR(motion.position[0], 0.0, 1e-12);
  EXPECT_NEAR(motion.position[1], 0.3, 1e-12);
}

TEST(Extrapolation, AgreesWithManySmallStepsInThreeDimensions) {
  const odometry_t message = tumblingCart();
  Eigen::Isometry3d pose = poseOf(extrapolate(message, kNow));
  constexpr int kSteps = 20'000;
  Vector6 step;
  step << 3.0, 0.2, -0.4, 0.5, -0.8, 1.2;
  for (int i = 0; i < kSteps; ++i)
    pose = pose * smallMotion(step / kSteps);
  const Eigen::Isometry3d extrapolated = poseOf(extrapolate(message, kNow + 1'000'000));
  EXPECT_LT((extrapolated.matrix() - pose.matrix()).norm(), 1e-8);
}

TEST(Extrapolation, StartsAtTheMessageAndNeverBefore) {
  odometry_t message = tumblingCart();
  setCovariances(message, someCovariance(1e-3), someCovariance(1e-2));
  for (const std::int64_t utime : {kNow, kNow - 10'000}) {
    const Motion motion = extrapolate(message, utime);
    EXPECT_EQ(motion.utime, kNow);
    EXPECT_NEAR(motion.position[0], 12.0, 1e-12);
    EXPECT_NEAR(motion.pose_covariance[7], message.pose_covariance_body[7], 1e-15);
    EXPECT_NEAR(motion.twist_covariance[8], message.twist_covariance_body[8], 1e-15);
  }
}

TEST(Extrapolation, PropagatesCovariancesAsNumericDerivativesDo) {
  odometry_t message = tumblingCart();
  const Matrix6 of_pose = someCovariance(1e-3), of_twist = someCovariance(1e-2);
  setCovariances(message, of_pose, of_twist);
  constexpr std::int64_t kThen = kNow + 250'000;
  const Motion motion = extrapolate(message, kThen, kNoNoise);

  constexpr double kStep = 1e-6;
  const Eigen::Isometry3d pose = poseOf(extrapolate(message, kNow)), then = poseOf(motion);
  Matrix6 by_pose, by_twist;
  for (int i = 0; i < 6; ++i) {
    odometry_t moved = message;
    setPose(moved, pose * smallMotion(kStep * Vector6::Unit(i)));
    by_pose.col(i) = toSmallMotion(then.inverse() * poseOf(extrapolate(moved, kThen))) / kStep;
    odometry_t faster = message;
    (i < 3 ? faster.velocity_body[i] : faster.angular_velocity_body[i - 3]) += kStep;
    by_twist.col(i) = toSmallMotion(then.inverse() * poseOf(extrapolate(faster, kThen))) / kStep;
  }
  const Matrix6 expected =
      by_pose * of_pose * by_pose.transpose() + by_twist * of_twist * by_twist.transpose();
  const Eigen::Map<const Matrix6> found(motion.pose_covariance.data());
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
  EXPECT_LT((Eigen::Map<const Matrix6>(motion.twist_covariance.data()) - of_twist).norm(), 1e-15);
}

TEST(Extrapolation, CovariancesGrowByTheUnknownAcceleration) {
  odometry_t message = test::validMessage();
  setCovariances(message, Matrix6::Zero(), Matrix6::Zero());
  const Motion motion = extrapolate(message, kNow + 200'000, {2.0, 3.0});
  EXPECT_NEAR(std::sqrt(motion.twist_covariance[0]), 2.0 * 0.2, 1e-12) << "m/s";
  EXPECT_NEAR(std::sqrt(motion.twist_covariance[35]), 3.0 * 0.2, 1e-12) << "rad/s";
  EXPECT_NEAR(std::sqrt(motion.pose_covariance[7]), 0.5 * 2.0 * 0.04, 1e-12) << "m";
  EXPECT_NEAR(std::sqrt(motion.pose_covariance[28]), 0.5 * 3.0 * 0.04, 1e-12) << "rad";
}

TEST(Extrapolation, StaysARotationAtTheLargestTurnRate) {
  odometry_t message = test::validMessage();
  message.angular_velocity_body[2] = 10.0;
  setCovariances(message, Matrix6::Identity(), Matrix6::Zero());
  const Motion motion = extrapolate(message, kNow + 1'000'000, kNoNoise);
  EXPECT_NEAR(motion.position[0], 0.3 * std::sin(10.0), 1e-10);
  EXPECT_NEAR(motion.position[1], 0.3 * (1.0 - std::cos(10.0)), 1e-10);
  EXPECT_NEAR(motion.pose_covariance[14], 1.0 + 2 * 0.09 * (1.0 - std::cos(10.0)), 1e-9)
      << "z by pitch and roll, over the chord";
}

}  // namespace
}  // namespace cartvo::client
