// Consistency of covariances with the truth, on a synthetic drive with known errors.
#include "tools/replay/truth_consistency.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "pipeline/body_motion.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kPeriod = 100'000'000;  // ns, 10 Hz

/// Errors of the synthetic odometry.
struct Behaviour {
  double noise = 1.0;       ///< factor on the standard deviations of the stated covariances
  std::size_t lost_at = 0;  ///< this pair and the next are invalid, then a new epoch begins; 0: none
};

vo::Matrix6d motionCovariance() {
  vo::Vector6d stddevs;
  stddevs << 0.01, 0.005, 0.02, 0.001, 0.002, 0.0005;
  return stddevs.cwiseAbs2().asDiagonal();
}

Eigen::Isometry3d trueStep(std::size_t index) {
  vo::Vector6d step;
  step << 0.02, -0.01, 0.8, 0.002, 0.03 * std::sin(0.1 * static_cast<double>(index)), -0.001;
  return vo::motionFromVector(step);
}

/// A drive of `count` pairs with an odometry whose errors are known.
struct SyntheticDrive {
  Replay replay;
  Trajectory left_camera;  // the truth

  SyntheticDrive(std::size_t count, const Behaviour& behaviour) {
    std::mt19937 generator(7);
    std::normal_distribution<double> normal;
    replay.rig.rig.T_body_camera = calib::forwardLookingMount();
    Eigen::Isometry3d T_first_left = Eigen::Isometry3d::Identity(), T_epoch_left = T_first_left;
    vo::Matrix6d pose_covariance = vo::Matrix6d::Zero();
    std::uint32_t epoch = 0;
    std::size_t reference = 0;
    for (std::size_t i = 0; i < count; ++i) {
      StampedPose stamped{static_cast<std::int64_t>(i) * kPeriod, Eigen::Isometry3d::Identity()};
      if (i > 0) stamped.pose = left_camera.back().pose * trueStep(i);
      left_camera.push_back(stamped);
      ReplayedPair pair;
      pair.exposure_ns = stamped.time_ns;
      const bool is_lost = behaviour.lost_at > 0 && (i == behaviour.lost_at || i == behaviour.lost_at + 1);
      pair.valid = i > 0 && !is_lost;
      if (pair.valid && behaviour.lost_at > 0 &&
          i == behaviour.lost_at + 2) {  // reference of the motion: the invalid pair before
        ++epoch;
        reference = i - 1;
        T_epoch_left.setIdentity();
        pose_covariance.setZero();
      }
      pair.reset_counter = epoch;
      pair.velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
      pair.angular_velocity = pair.velocity;
      if (pair.valid) {
        const Eigen::Isometry3d motion = left_camera[reference].pose.inverse() * stamped.pose;
        vo::Vector6d error;
        const vo::Vector6d stddevs = motionCovariance().diagonal().cwiseSqrt();
        for (int k = 0; k < 6; ++k)
          error[k] = behaviour.noise * stddevs[k] * normal(generator);
        pair.T_previous_current = motion * vo::motionFromVector(error);
        pair.motion_covariance = motionCovariance();
        pair.time_step = 1e-9 * static_cast<double>(pair.exposure_ns - replay.pairs[reference].exposure_ns);
        pose_covariance =
            vo::composedCovariance(pose_covariance, pair.T_previous_current, pair.motion_covariance);
        T_epoch_left = T_epoch_left * pair.T_previous_current;
        T_first_left = T_first_left * pair.T_previous_current;
        reference = i;
        const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
        const vo::Vector6d twist =
            pipeline::logarithm(T_body_left * pair.T_previous_current * T_body_left.inverse()) /
            pair.time_step;
        pair.velocity = twist.head<3>();
        pair.angular_velocity = twist.tail<3>();
      }
      pair.T_epoch_left = T_epoch_left;
      pair.T_first_left = T_first_left;
      pair.pose_covariance = pose_covariance;
      pair.twist_covariance.setIdentity();
      replay.pairs.push_back(pair);
    }
  }

  Trajectory body() const {
    const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
    Trajectory poses = left_camera;
    for (StampedPose& stamped : poses)
      stamped.pose = T_body_left * stamped.pose * T_body_left.inverse();
    return poses;
  }

  TruthConsistency consistency() const {
    const Trajectory poses = body();
    Truth truth;
    for (const StampedPose& stamped : poses)
      truth.emplace_back(stamped.pose);
    return consistencyWithTruth(replay, truth, TrueTwist(poses));
  }
};

TruthConsistency consistencyOf(std::size_t count, const Behaviour& behaviour) {
  return SyntheticDrive(count, behaviour).consistency();
}

TEST(TruthConsistency, OfConsistentOdometryIsInsideTheBands) {
  const TruthConsistency consistency = consistencyOf(400, {});
  EXPECT_EQ(consistency.motion.groups(), 399u);
  EXPECT_TRUE(consistency.motion.band().contains(consistency.motion.mean())) << consistency.motion.mean();
  EXPECT_EQ(consistency.pose.groups(), 1u);
  EXPECT_TRUE(consistency.pose.band().contains(consistency.pose.mean())) << consistency.pose.mean();
  EXPECT_EQ(consistency.standing, 0u);
  const nlohmann::ordered_json json = consistencyJson(consistency);
  EXPECT_EQ(json["nees_motion"]["samples"], 399);
  EXPECT_TRUE(json["standing_highest_speed_m_s"].is_null());
}

TEST(TruthConsistency, OfOverconfidentOdometryIsAboveTheBand) {
  const TruthConsistency consistency = consistencyOf(400, {.noise = 1.5});
  EXPECT_GT(consistency.motion.mean(), consistency.motion.band().high);
}

TEST(TruthConsistency, OfPosesIsFromTheStartOfTheNewEpochAfterAReset) {
  const TruthConsistency consistency = consistencyOf(400, {.lost_at = 200});
  EXPECT_EQ(consistency.motion.groups(), 397u);
  EXPECT_EQ(consistency.pose.groups(), 2u);
  EXPECT_TRUE(consistency.pose.band().contains(consistency.pose.mean())) << consistency.pose.mean();
}

TEST(TruthConsistency, OfVelocitiesIsWithTheTwistAtTheExposure) {
  SyntheticDrive drive(20, {.noise = 0.0});
  const TrueTwist twist(drive.body());
  std::size_t known = 0;
  for (ReplayedPair& pair : drive.replay.pairs) {
    const std::optional<vo::Vector6d> true_twist = twist.at(pair.exposure_ns);
    if (!true_twist) continue;
    ++known;
    pair.velocity = true_twist->head<3>() + Eigen::Vector3d::UnitX();  // 1 m/s off, with a stddev of 1 m/s
    pair.angular_velocity = true_twist->tail<3>();
  }
  const TruthConsistency consistency = drive.consistency();
  EXPECT_EQ(consistency.velocity.groups(), known);
  EXPECT_NEAR(consistency.velocity.mean(), 1.0 / 6.0, 1e-9);
  EXPECT_NEAR(consistency.rate_error, 0.0, 1e-9);
  EXPECT_GT(consistency.true_rate, 0.1) << "rad/s: 0.03 rad in a tenth of a second";
}

TEST(TruthConsistency, ReportsTheHighestSpeedAtStandstill) {
  SyntheticDrive drive(10, {.noise = 0.0});
  for (StampedPose& stamped : drive.left_camera)
    stamped.pose.setIdentity();
  for (std::size_t i = 0; i < drive.replay.pairs.size(); ++i) {
    drive.replay.pairs[i].T_previous_current.setIdentity();
    drive.replay.pairs[i].velocity = Eigen::Vector3d(0.0, i == 4 ? 0.03 : 0.01, 0.0);
  }
  const TruthConsistency consistency = drive.consistency();
  EXPECT_EQ(consistency.standing, 9u);
  EXPECT_DOUBLE_EQ(consistency.standing_speed, 0.03);
  EXPECT_EQ(consistency.motion.groups(), 0u) << "zero-velocity updates are not measured motions";
  EXPECT_EQ(consistencyJson(consistency)["standing_highest_speed_m_s"], 0.03);
}

}  // namespace
}  // namespace cartvo
