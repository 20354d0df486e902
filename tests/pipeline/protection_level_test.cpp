// Bounds of errors: against computed numbers and errors drawn by the model; their alert limits.

#include "pipeline/protection_level.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo::pipeline {
namespace {

constexpr double kTranslationStddev = 0.002;  // m
constexpr double kRotationStddev = 0.0003;    // rad
constexpr double kMotionTime = 0.1;           // s: ten motions are a second

vo::Matrix6d noiseCovariance() {
  vo::Vector6d variances;
  variances << Eigen::Vector3d::Constant(kTranslationStddev * kTranslationStddev),
      Eigen::Vector3d::Constant(kRotationStddev * kRotationStddev);
  return variances.asDiagonal();
}

vo::OdometryEstimate estimateWithNoise(const Eigen::Isometry3d& motion) {
  vo::OdometryEstimate estimate;
  estimate.valid = true;
  estimate.time_step = kMotionTime;
  estimate.T_previous_current = motion;
  estimate.motion_covariance = noiseCovariance();
  return estimate;
}

/// Ahead by so much.
Eigen::Isometry3d motionAhead(double distance) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translation().x() = distance;
  return motion;
}

vo::UncertaintySettings withoutDrift() {
  vo::UncertaintySettings settings;
  settings.drift_ratio = 0.0;
  return settings;
}

/// The level after so many estimates of one motion, whose camera is the body and which are VALID unless
/// stated.
ProtectionLevel levelAfter(ProtectionLevels& levels, int count, const vo::OdometryEstimate& estimate,
                           bool valid = true) {
  ProtectionLevel level;
  for (int i = 0; i < count; ++i) {
    level = levels.update(estimate, bodyMotion(estimate, Eigen::Isometry3d::Identity()));
    if (valid && estimate.valid) levels.setValid();
  }
  return level;
}

TEST(ProtectionLevel, OfAVelocityIsAMultipleOfItsStandardDeviationAndAKerb) {
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), 0.0, withoutDrift());
  const vo::OdometryEstimate estimate = estimateWithNoise(motionAhead(0.3));
  BodyMotion motion = bodyMotion(estimate, Eigen::Isometry3d::Identity());
  motion.twist_covariance = vo::Vector6d(0.01, 0.04, 0.09, 0.0001, 0.0004, 0.0009).asDiagonal();
  const ProtectionLevel level = levels.update(estimate, motion);
  const double by_kerb = kUnannouncedJerk / 3.0 * estimate.time_step * estimate.time_step;
  EXPECT_NEAR(level.velocity.x(), kBoundFactor * 0.1 + by_kerb, 1e-12);
  EXPECT_NEAR(level.velocity.z(), kBoundFactor * 0.3 + by_kerb, 1e-12);
  EXPECT_NEAR(level.angular_rate.y(), kBoundFactor * 0.02 + 0.1, 1e-12) << "all that a kerb does";
}

TEST(ProtectionLevel, OfAVelocityHasNoKerbWhenTheCartHasStoodForASecond) {
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), 0.0, withoutDrift());
  vo::OdometryEstimate estimate = estimateWithNoise(motionAhead(0.1));
  levelAfter(levels, 1, estimate);
  const double by_kerb = kUnannouncedJerk / 3.0 * estimate.time_step * estimate.time_step;
  estimate.T_previous_current.setIdentity();
  estimate.reasons = vo::OdometryReason::zero_velocity;
  EXPECT_GT(levelAfter(levels, 9, estimate).velocity.minCoeff(), by_kerb) << "it may sway on its springs";
  EXPECT_LT(levelAfter(levels, 1, estimate).velocity.maxCoeff(), by_kerb);
}

TEST(ProtectionLevel, GrowsOverTheLastSecondOnly) {
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), 0.0, withoutDrift());
  const vo::OdometryEstimate standing = estimateWithNoise(motionAhead(0.0));
  EXPECT_NEAR(levelAfter(levels, 1, standing).motion.x(), kMotionFloor + kBoundFactor * kTranslationStddev,
              1e-12);
  EXPECT_NEAR(levelAfter(levels, 4, standing).motion.x(),
              kMotionFloor + kBoundFactor * 2.0 * kTranslationStddev, 1e-12)
      << "four independent motions since the first VALID pose";
  const double of_a_second = kBoundFactor * std::sqrt(10.0) * kTranslationStddev;
  EXPECT_NEAR(levelAfter(levels, 20, standing).motion.x(), kMotionFloor + of_a_second, 1e-12);
  EXPECT_NEAR(levelAfter(levels, 1, standing).rotation.y(),
              kRotationFloor + kBoundFactor * std::sqrt(10.0) * kRotationStddev, 1e-12);
}

TEST(ProtectionLevel, HasTheSidewaysErrorOfAHeadingThatIsOff) {
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), 0.0, withoutDrift());
  constexpr double kStep = 0.3;  // m
  const ProtectionLevel level = levelAfter(levels, 11, estimateWithNoise(motionAhead(kStep)));
  double variance = 10.0 * kTranslationStddev * kTranslationStddev;
  for (int behind = 0; behind < 10; ++behind)
    variance += std::pow(behind * kStep * kRotationStddev, 2);
  const double added = kMotionFloor + kWayShare * 10.0 * kStep;
  EXPECT_NEAR(level.motion.y(), added + kBoundFactor * std::sqrt(variance), 1e-12);
  EXPECT_NEAR(level.motion.x(), added + kBoundFactor * std::sqrt(10.0) * kTranslationStddev, 1e-12);
}

TEST(ProtectionLevel, AddsTheErrorsOfTheScaleWithTheirSigns) {
  constexpr double kScale = 0.02, kStep = 0.3;
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), kScale, withoutDrift());
  const ProtectionLevel level = levelAfter(levels, 11, estimateWithNoise(motionAhead(kStep)));
  const double independent = 10.0 * kTranslationStddev * kTranslationStddev;
  const double common = std::pow(10.0 * kScale * kStep, 2);
  EXPECT_NEAR(level.motion.x(),
              kMotionFloor + kWayShare * 10.0 * kStep + kBoundFactor * std::sqrt(independent + common), 1e-9);
}

TEST(ProtectionLevel, BeginsAnewWithAnEpochAndGoesOnBehindAGap) {
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), 0.0, withoutDrift());
  vo::OdometryEstimate estimate = estimateWithNoise(motionAhead(0.0));
  levelAfter(levels, 4, estimate);
  vo::OdometryEstimate lost;
  EXPECT_TRUE(levelAfter(levels, 1, lost).motion.array().isNaN().all());
  EXPECT_NEAR(levelAfter(levels, 6, estimate).motion.x(),
              kMotionFloor + kBoundFactor * 3.0 * kTranslationStddev, 1e-12);
  estimate.reset_counter = 1;
  EXPECT_NEAR(levelAfter(levels, 1, estimate).motion.x(), kMotionFloor + kBoundFactor * kTranslationStddev,
              1e-12);
  estimate.time_step = 1.4;
  EXPECT_NEAR(levelAfter(levels, 1, estimate).motion.x(), kMotionFloor + kBoundFactor * kTranslationStddev,
              1e-12)
      << "one motion over a gap of more than a second";
}

TEST(ProtectionLevel, IsOfTheMotionSinceTheOldestValidPose) {
  ProtectionLevels levels(Eigen::Isometry3d::Identity(), 0.0, withoutDrift());
  const vo::OdometryEstimate estimate = estimateWithNoise(motionAhead(0.0));
  const auto bound_of = [](int motions) {
    return kMotionFloor + kBoundFactor * std::sqrt(motions) * kTranslationStddev;
  };
  vo::OdometryEstimate first = estimate;
  first.motion_covariance *= 100.0;
  EXPECT_NEAR(levelAfter(levels, 2, first, false).motion.x(),
              kMotionFloor + 10.0 * kBoundFactor * kTranslationStddev, 1e-12)
      << "of the last motion alone: no pose is VALID";
  EXPECT_NEAR(levelAfter(levels, 1, estimate).motion.x(), bound_of(1), 1e-12);
  EXPECT_NEAR(levelAfter(levels, 1, estimate).motion.x(), bound_of(1), 1e-12) << "since the first VALID pose";
  EXPECT_NEAR(levelAfter(levels, 1, estimate).motion.x(), bound_of(2), 1e-12);
  EXPECT_NEAR(levelAfter(levels, 3, estimate, false).motion.x(), bound_of(5), 1e-12)
      << "INVALID motions between VALID poses count";
  EXPECT_NEAR(levelAfter(levels, 20, estimate, false).motion.x(), bound_of(1), 1e-12)
      << "no pose of the last second is VALID";
}

/// Motions on a bend whose errors are independent noise and a drift as ProtectionLevels has it: the errors of
/// the motion over a second, in body axes.
class DrawnSecond {
 public:
  explicit DrawnSecond(const Eigen::Isometry3d& T_body_camera) : T_body_camera_(T_body_camera) {
    step_ = motionAhead(0.3);
    step_.rotate(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()));
  }

  const Eigen::Isometry3d& step() const { return step_; }

  vo::Vector6d draw(const vo::UncertaintySettings& settings) {
    const double correlation = std::exp(-1.0 / settings.drift_correlation_pairs);
    vo::Vector6d drift = std::sqrt(settings.drift_ratio) * noise();
    Eigen::Isometry3d truth = Eigen::Isometry3d::Identity(), measured = truth;
    for (int i = 0; i < 10; ++i) {
      drift =
          correlation * drift + std::sqrt((1.0 - correlation * correlation) * settings.drift_ratio) * noise();
      measured = measured * step_;
      truth = truth * step_ * vo::motionFromVector(noise() + drift);
    }
    const Eigen::Isometry3d T_camera_body = T_body_camera_.inverse();
    return vo::vectorFromMotion((T_body_camera_ * measured * T_camera_body).inverse() *
                                (T_body_camera_ * truth * T_camera_body));
  }

 private:
  vo::Vector6d noise() {
    vo::Vector6d values;
    for (int i = 0; i < 6; ++i)
      values[i] = (i < 3 ? kTranslationStddev : kRotationStddev) * normal_(random_);
    return values;
  }

  Eigen::Isometry3d T_body_camera_, step_;
  std::mt19937 random_{53};
  std::normal_distribution<double> normal_;
};

TEST(ProtectionLevel, FitsErrorsDrawnWithDriftOnABend) {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  T_body_camera.translation() = Eigen::Vector3d(0.5, 0.3, 1.9);
  T_body_camera.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.6, 0.8, 0.0)));
  const vo::UncertaintySettings settings;
  DrawnSecond drawn(T_body_camera);
  ProtectionLevels levels(T_body_camera, 0.0, settings);
  const ProtectionLevel level = levelAfter(levels, 11, estimateWithNoise(drawn.step()));
  vo::Vector6d bounds;
  Eigen::Isometry3d way = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 10; ++i)
    way = way * drawn.step();
  bounds << level.motion.array() - kMotionFloor - kWayShare * way.translation().norm(),
      level.rotation.array() - kRotationFloor;

  constexpr int kDraws = 4000;
  vo::Vector6d squares = vo::Vector6d::Zero();
  for (int i = 0; i < kDraws; ++i)
    squares += drawn.draw(settings).cwiseAbs2();
  const vo::Vector6d stddevs = (squares / kDraws).cwiseSqrt();
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(kBoundFactor * stddevs[i] / bounds[i], 1.0, 0.04) << i;
}

TEST(AlertLimit, IsHeldByEachBound) {
  const AlertLimits limits{0.3, 0.05, 0.15, 0.025};
  ProtectionLevel level{Eigen::Vector3d::Constant(0.03), Eigen::Vector3d::Constant(0.01),
                        Eigen::Vector3d::Constant(0.03), Eigen::Vector3d::Constant(0.005)};
  EXPECT_FALSE(worstBound(level, limits).isExceeded());
  EXPECT_EQ(worstBound(level, limits).quality(), 80);
  for (Eigen::Vector3d* bounds : {&level.velocity, &level.angular_rate, &level.motion, &level.rotation}) {
    for (int axis = 0; axis < 3; ++axis) {
      const double before = (*bounds)[axis];
      for (const double too_large :
           {0.3, 1e3, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        (*bounds)[axis] = too_large;
        const LimitedBound worst = worstBound(level, limits);
        EXPECT_TRUE(worst.isExceeded());
        EXPECT_EQ(worst.axis, axis);
        EXPECT_EQ(worst.quality(), 0);
      }
      (*bounds)[axis] = before;
    }
  }
  EXPECT_EQ((LimitedBound{.bound = 0.299999, .limit = 0.3}.quality()), 1) << "0 is for INVALID";
  EXPECT_EQ((LimitedBound{.bound = 0.0, .limit = 0.3}.quality()), 100);
}

TEST(AlertLimit, IsNamedInWordsWithTheBound) {
  EXPECT_EQ((LimitedBound{BoundedQuantity::velocity, 0, 0.42, 0.3}.text()),
            "forward velocity is known to 0.42 m/s, alert limit 0.30 m/s");
  EXPECT_EQ((LimitedBound{BoundedQuantity::rotation, 2, 0.1, AlertLimits{}.rotation}.text()),
            "yaw of the last second is known to 5.73 deg, alert limit 1.50 deg");
}

}  // namespace
}  // namespace cartvo::pipeline
