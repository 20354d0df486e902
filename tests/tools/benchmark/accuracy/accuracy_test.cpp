// Tests of accuracy, consistency and rate errors on a synthetic drive with known errors.
#include "tools/benchmark/accuracy/accuracy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "pipeline/body_motion.hpp"
#include "tools/benchmark/thesis/rate_errors.hpp"

namespace cartvo::benchmark {
namespace {

constexpr std::int64_t kPeriod = 100'000'000;  // ns, 10 Hz

/// Errors of the synthetic odometry.
struct Behaviour {
  double noise = 1.0;       ///< factor on the standard deviations of the stated covariances
  std::size_t lost_at = 0;  ///< this pair and the next are invalid, then a new epoch begins; 0: none
  std::size_t off_at = 0;   ///< this pair's motion is off by 20 cm in 0.1 s; 0: none
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

/// The message of a pair, with bounds that are far above all errors.
odometry_t messageOf(const ReplayedPair& pair, const Eigen::Isometry3d& T_body_left) {
  odometry_t message{};
  message.status = pair.valid ? odometry_t::VALID : odometry_t::INVALID;
  message.reset_counter = static_cast<std::int32_t>(pair.reset_counter);
  const Eigen::Isometry3d T_world_body = T_body_left * pair.T_epoch_left * T_body_left.inverse();
  const Eigen::Quaterniond q(T_world_body.linear());
  const std::array<double, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz.begin(), wxyz.end(), message.orientation_world_body);
  Eigen::Map<Eigen::Vector3d>(message.position_world_body) = T_world_body.translation();
  Eigen::Map<Eigen::Vector3d>(message.velocity_body) = pair.velocity;
  Eigen::Map<Eigen::Vector3d>(message.angular_velocity_body) = pair.angular_velocity;
  for (double* bound :
       {message.velocity_bound, message.angular_rate_bound, message.motion_bound, message.rotation_bound})
    std::fill(bound, bound + 3, 100.0);
  return message;
}

/// A drive of `count` pairs with an odometry whose errors are known.
struct SyntheticDrive {
  Replay replay;
  SequenceTruth truth;

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
      if (i > 0) stamped.pose = truth.left_camera.back().pose * trueStep(i);
      truth.left_camera.push_back(stamped);
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
        const Eigen::Isometry3d motion = truth.left_camera[reference].pose.inverse() * stamped.pose;
        vo::Vector6d error;
        const vo::Vector6d stddevs = motionCovariance().diagonal().cwiseSqrt();
        for (int k = 0; k < 6; ++k)
          error[k] = behaviour.noise * stddevs[k] * normal(generator);
        if (i == behaviour.off_at) error.z() += 0.2;
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
      pair.times.total = i == 0 ? 1.0 : 0.01;
      pair.message = messageOf(pair, replay.rig.rig.T_body_camera);
      replay.pairs.push_back(pair);
    }
  }
};

SequenceAccuracy accuracyOf(std::size_t count, const Behaviour& behaviour) {
  const SyntheticDrive drive(count, behaviour);
  return measureAccuracy(drive.replay, drive.truth, {});
}

TEST(Accuracy, ConsistentOdometryIsInsideTheBands) {
  const SequenceAccuracy accuracy = accuracyOf(400, {});
  EXPECT_EQ(accuracy.pairs, 400u);
  EXPECT_EQ(accuracy.invalid + accuracy.lost + accuracy.resets, 0u);
  EXPECT_EQ(accuracy.consistency.motion.groups(), 399u);
  EXPECT_TRUE(accuracy.consistency.motion.band().contains(accuracy.consistency.motion.mean()))
      << accuracy.consistency.motion.mean();
  EXPECT_EQ(accuracy.consistency.pose.groups(), 1u);
  EXPECT_TRUE(accuracy.consistency.pose.band().contains(accuracy.consistency.pose.mean()))
      << accuracy.consistency.pose.mean();
  EXPECT_EQ(accuracy.consistency.velocity.groups(), 0u) << "this truth has no twist";
  EXPECT_FALSE(accuracy.standing_end);
  ASSERT_EQ(accuracy.times_ms.size(), 399u);
  EXPECT_DOUBLE_EQ(accuracy.times_ms.front(), 10.0) << "the first pair's time must not count";
}

TEST(Accuracy, OverconfidentOdometryIsAboveTheBand) {
  const SequenceAccuracy accuracy = accuracyOf(400, {.noise = 1.5});
  EXPECT_GT(accuracy.consistency.motion.mean(), accuracy.consistency.motion.band().high);
}

TEST(Accuracy, CountsMessagesAboveALimitWhateverTheyState) {
  // 2 m/s off for one message, and 20 cm, just the limit, for all whose last second has that motion.
  const ValidityFigures validity = accuracyOf(50, {.noise = 0.0, .off_at = 20}).validity;
  EXPECT_EQ(validity.messages, 50u);
  EXPECT_EQ(validity.valid, 49u);
  EXPECT_EQ(validity.above_limit, 1u);
  EXPECT_EQ(validity.above_bound, 0u) << "they state 100 m/s";
  EXPECT_NEAR(validity.velocity_error, 2.0, 0.05);
}

TEST(Accuracy, JudgesByTheExactTwistWhereItIsKnown) {
  SyntheticDrive drive(30, {.noise = 0.0});
  drive.truth.body_twist.assign(30, vo::Vector6d::Zero());  // the odometry reports 8 m/s
  EXPECT_EQ(measureAccuracy(drive.replay, drive.truth, {}).validity.above_limit, 29u);
  drive.truth.body_twist.clear();
  EXPECT_EQ(measureAccuracy(drive.replay, drive.truth, {}).validity.above_limit, 0u);
}

TEST(Accuracy, MeasuresPoseFromTheStartOfTheNewEpochAfterAReset) {
  const SequenceAccuracy accuracy = accuracyOf(400, {.lost_at = 200});
  EXPECT_EQ(accuracy.invalid, 2u);
  EXPECT_EQ(accuracy.resets, 1u);
  EXPECT_EQ(accuracy.consistency.motion.groups(), 397u);
  EXPECT_EQ(accuracy.consistency.pose.groups(), 2u);
  EXPECT_TRUE(accuracy.consistency.pose.band().contains(accuracy.consistency.pose.mean()))
      << accuracy.consistency.pose.mean();
}

TEST(Accuracy, CountsPairsThatWereNotFormed) {
  SyntheticDrive drive(20, {});
  drive.replay.pairs.pop_back();
  EXPECT_EQ(measureAccuracy(drive.replay, drive.truth, {}).lost, 1u);
}

TEST(Accuracy, ComparesVelocityWithTheTwistAtTheExposure) {
  SyntheticDrive drive(20, {.noise = 0.0});
  const vo::Vector6d off = (vo::Vector6d() << 1.0, 0, 0, 0, 0, 0).finished();
  for (std::size_t i = 0; i < drive.replay.pairs.size(); ++i) {
    vo::Vector6d twist = vo::Vector6d::Zero();
    if (i > 0) twist << drive.replay.pairs[i].velocity, drive.replay.pairs[i].angular_velocity;
    drive.truth.body_twist.emplace_back(twist + off);  // error of 1 m/s with a stddev of 1 m/s
  }
  const SequenceAccuracy accuracy = measureAccuracy(drive.replay, drive.truth, {});
  EXPECT_EQ(accuracy.consistency.velocity.groups(), 19u);
  EXPECT_NEAR(accuracy.consistency.velocity.mean(), 1.0 / 6.0, 1e-9);
}

TEST(Accuracy, ReportsEndErrorAndHighestSpeedAtStandstill) {
  SyntheticDrive drive(10, {.noise = 0.0});
  for (StampedPose& stamped : drive.truth.left_camera)
    stamped.pose.setIdentity();
  for (std::size_t i = 0; i < drive.replay.pairs.size(); ++i) {
    drive.replay.pairs[i].T_previous_current.setIdentity();
    drive.replay.pairs[i].T_first_left.setIdentity();
    drive.replay.pairs[i].T_first_left.translation().x() = 0.001 * static_cast<double>(i);
    drive.replay.pairs[i].velocity = Eigen::Vector3d(0.0, i == 4 ? 0.03 : 0.01, 0.0);
  }
  const SequenceAccuracy accuracy = measureAccuracy(drive.replay, drive.truth, {});
  ASSERT_TRUE(accuracy.standing_end);
  EXPECT_NEAR(accuracy.standing_end->translation, 0.009, 1e-9);
  EXPECT_EQ(accuracy.standing, 9u);
  EXPECT_DOUBLE_EQ(accuracy.standing_speed, 0.03);
  EXPECT_EQ(accuracy.consistency.motion.groups(), 0u) << "zero-velocity updates are not measured motions";
}

TEST(Accuracy, SummaryPoolsSegmentsAndMotions) {
  std::vector<SequenceAccuracy> both{accuracyOf(100, {}), accuracyOf(200, {.noise = 2.0})};
  both[0].standing_end = {0.01, 0.001};
  both[1].standing_end = {0.004, 0.002};
  const SequenceAccuracy all = summarise("both", both);
  EXPECT_EQ(all.sequence, "both");
  EXPECT_EQ(all.pairs, 300u);
  EXPECT_EQ(all.consistency.motion.groups(), 99u + 199u);
  EXPECT_EQ(all.consistency.pose.groups(), 2u);
  EXPECT_DOUBLE_EQ(all.standing_end->translation, 0.01);
  EXPECT_DOUBLE_EQ(all.standing_end->rotation, 0.002);
  const SegmentErrors &first = both[0].evaluation.short_segments.all,
                      &second = both[1].evaluation.short_segments.all,
                      &pooled = all.evaluation.short_segments.all;
  EXPECT_EQ(pooled.count, first.count + second.count);
  EXPECT_NEAR(pooled.translation * pooled.count,
              first.translation * first.count + second.translation * second.count, 1e-9);
  const auto square = [](double value) { return value * value; };
  EXPECT_NEAR(square(all.evaluation.relative_translation) * (99 + 199),
              square(both[0].evaluation.relative_translation) * 99 +
                  square(both[1].evaluation.relative_translation) * 199,
              1e-9);
  EXPECT_NEAR(*all.evaluation.final_drift_fraction,
              (*both[0].evaluation.final_drift_fraction + *both[1].evaluation.final_drift_fraction) / 2.0,
              1e-12);
}

TEST(RateErrors, AreZeroForTheTruthAndEqualToTheNoiseOtherwise) {
  const SyntheticDrive exact(50, {.noise = 0.0});
  const RateErrors none = rateErrors(exact.replay, exact.truth);
  EXPECT_EQ(none.pairs, 49u);
  EXPECT_LT(none.velocity.norm() + none.pitch + none.yaw + none.roll, 1e-9);

  const SyntheticDrive noisy(2000, {});
  const RateErrors errors = rateErrors(noisy.replay, noisy.truth);
  // Body x is camera z, body y is camera -x; the noise of a motion is divided by the step of 0.1 s.
  EXPECT_NEAR(errors.velocity.x(), 0.2, 0.02);
  EXPECT_NEAR(errors.velocity.y(), 0.1, 0.03);
  // Pitch, yaw and roll are rotations about the x, y and z axes of the camera.
  EXPECT_NEAR(errors.pitch, 0.01, 0.001);
  EXPECT_NEAR(errors.yaw, 0.02, 0.002);
  EXPECT_NEAR(errors.roll, 0.005, 0.0005);
}

}  // namespace
}  // namespace cartvo::benchmark
