// Tests of the rig's self-calibration on rendered drives with a rotated or delayed right camera.
#include "vo_core/self_calibration/rig_calibration.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/units.hpp"
#include "support/vo_core/corridor_world.hpp"
#include "support/vo_core/night.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr double kPeriod = 0.05;  // s
constexpr double kTolerance = 0.03 * kRadiansPerDegree;
constexpr int kFeatures = 400, kFeaturesAtNight = 1000;
constexpr int kPairs = 16, kPairsOfABump = 40;

/// 3 m/s, swinging from side to side and nodding.
Eigen::Isometry3d drive(double time) {
  Vector6d vector;
  vector << 0.0, 0.02 * std::sin(6.0 * time), 3.0 * time, 0.02 * std::sin(8.0 * time),
      0.1 * std::sin(3.0 * time), 0.0;
  return motionFromVector(vector);
}

/// Left images, rendered once.
const cv::Mat& leftImage(const test::CorridorWorld& world, int i) {
  static const std::vector<cv::Mat> images = [&world] {
    std::vector<cv::Mat> rendered;
    for (int frame = 0; frame < kPairsOfABump; ++frame)
      rendered.push_back(world.view(kCamera, drive(frame * kPeriod)));
    return rendered;
  }();
  return images[i];
}

/// Pairs of a right camera rotated by `turned`, from the pair `first` on, and exposed `late` s later than its
/// timestamps.
std::vector<StereoImages> drivenWith(const RigCorrection& turned, double late, int count, int first = 0) {
  const test::CorridorWorld world(1);
  std::vector<StereoImages> pairs;
  for (int i = 0; i < count; ++i) {
    const double time = i * kPeriod;
    Eigen::Isometry3d right = drive(time + late) * Eigen::Translation3d(kCamera.baseline, 0.0, 0.0);
    if (i >= first) right.rotate(turned.rotation());
    const std::int64_t stamp = std::llround(1e9 * time);
    pairs.push_back({leftImage(world, i), world.view(kCamera, right), stamp, stamp});
  }
  return pairs;
}

struct Driven {
  RigCalibrationError error;
  double path = 0.0;  ///< m, estimated
  std::vector<OdometryEstimate> estimates;
};

Driven estimated(const std::vector<StereoImages>& pairs, int features) {
  OdometrySettings settings;
  settings.features = features;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  Driven result;
  for (const StereoImages& pair : pairs) {
    const OdometryEstimate& estimate = result.estimates.emplace_back(odometry.process(pair, observer));
    EXPECT_TRUE(estimate.rig.has_value());
    result.error = estimate.rig.value_or(RigCalibrationError{});
    result.path += estimate.T_previous_current.translation().norm();
  }
  return result;
}

Driven estimated(const std::vector<StereoImages>& pairs) {
  return estimated(pairs, kFeatures);
}

Driven driven(const RigCorrection& turned, double late) {
  return estimated(drivenWith(turned, late, kPairs));
}

constexpr double kTruePath = 3.0 * kPeriod * (kPairs - 1);  // m, without the swing

TEST(RigCalibrationError, FindsAndCorrectsPitchAndRoll) {
  const RigCorrection turned{.pitch = 0.3 * kRadiansPerDegree, .roll = -0.3 * kRadiansPerDegree};
  const Driven result = driven(turned, 0.0);
  EXPECT_NEAR(result.error.pitch.value, turned.pitch, kTolerance);
  EXPECT_NEAR(result.error.roll.value, turned.roll, kTolerance);
  EXPECT_NEAR(result.error.yaw.value, 0.0, kTolerance);
  EXPECT_NEAR(result.path, kTruePath, 0.03 * kTruePath);
}

TEST(RigCalibrationError, FindsAPitchThatPreventsMostMatches) {
  // 0.5 degrees are 2.3 px, beyond the range of the search over rows.
  const Driven result = driven({.pitch = -0.5 * kRadiansPerDegree}, 0.0);
  EXPECT_NEAR(result.error.pitch.value, -0.5 * kRadiansPerDegree, kTolerance);
  EXPECT_NEAR(result.path, kTruePath, 0.03 * kTruePath);
}

TEST(RigCalibrationError, FindsAYawAndSpeedsDespiteIt) {
  for (const double degrees : {-0.3, 0.3, 0.8, 1.5}) {
    const Driven result = driven({.yaw = degrees * kRadiansPerDegree}, 0.0);
    EXPECT_NEAR(result.error.yaw.value, degrees * kRadiansPerDegree, kTolerance) << degrees;
    EXPECT_NEAR(result.path, kTruePath, 0.02 * kTruePath) << degrees;
    for (std::size_t i = 1; i < result.estimates.size(); ++i) {
      EXPECT_TRUE(result.estimates[i].valid) << degrees << ", pair " << i;
      const double speed = result.estimates[i].T_previous_current.translation().norm() / kPeriod;
      EXPECT_NEAR(speed, 3.0, 0.1) << degrees << ", pair " << i;
    }
  }
}

TEST(RigCalibrationError, FindsAllAnglesAtOnce) {
  const RigCorrection turned{
      .yaw = -0.3 * kRadiansPerDegree, .pitch = 0.3 * kRadiansPerDegree, .roll = -0.3 * kRadiansPerDegree};
  const Driven result = driven(turned, 0.0);
  EXPECT_NEAR(result.error.pitch.value, turned.pitch, kTolerance);
  EXPECT_NEAR(result.error.yaw.value, turned.yaw, kTolerance);
  EXPECT_NEAR(result.error.roll.value, turned.roll, kTolerance);
  EXPECT_NEAR(result.path, kTruePath, 0.02 * kTruePath);
}

/// Somebody pushes the right camera while the cart drives.
TEST(RigCalibrationError, FollowsABump) {
  constexpr int kBump = 12;
  constexpr double kWay = 3.0 * kPeriod * (kPairsOfABump - 1);
  for (const double degrees : {0.05, 0.15, 0.5}) {
    const double pitch = degrees * kRadiansPerDegree;
    const Driven result = estimated(drivenWith({.pitch = pitch}, 0.0, kPairsOfABump, kBump));
    EXPECT_NEAR(result.error.pitch.value, pitch, kTolerance) << degrees;
    EXPECT_NEAR(result.path, kWay, 0.03 * kWay) << degrees;
  }
}

std::vector<StereoImages> atNight(std::vector<StereoImages> pairs) {
  cv::RNG random(7);
  for (StereoImages& pair : pairs)
    for (cv::Mat* image : {&pair.left, &pair.right})
      *image = test::atNight(*image, random);
  return pairs;
}

TEST(RigCalibrationError, FindsAPitchAtNight) {
  const auto pairs = atNight(drivenWith({.pitch = 0.5 * kRadiansPerDegree}, 0.0, kPairs));
  const Driven corrected = estimated(pairs, kFeaturesAtNight);
  EXPECT_NEAR(corrected.error.pitch.value, 0.5 * kRadiansPerDegree, kTolerance);
  EXPECT_NEAR(corrected.path, kTruePath, 0.1 * kTruePath);
}

TEST(RigCalibrationError, FindsNoErrorOfACorrectRigAtNight) {
  const auto pairs = atNight(drivenWith({}, 0.0, kPairs));
  EXPECT_NEAR(estimated(pairs, kFeaturesAtNight).error.pitch.value, 0.0, kTolerance);
}

/// Pairs of different worlds, so that no motion is found; the right camera is rotated and, in the first pair,
/// covered.
std::vector<StereoImages> lostWith(const RigCorrection& turned, int count) {
  Eigen::Isometry3d right(Eigen::Translation3d(kCamera.baseline, 0.0, 0.0));
  right.rotate(turned.rotation());
  std::vector<StereoImages> pairs;
  for (int i = 0; i < count; ++i) {
    const test::CorridorWorld world(i);
    const std::int64_t stamp = std::llround(1e9 * i * kPeriod);
    pairs.push_back(
        {world.view(kCamera, Eigen::Isometry3d::Identity()), world.view(kCamera, right), stamp, stamp});
  }
  pairs.front().right = cv::Mat(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(100));
  return pairs;
}

TEST(RigCalibrationError, SearchesThePitchAtIntervalsWhileLost) {
  constexpr int kSearchInterval = pitch_search::kSearchInterval;
  // The first pair of the next epoch, whose estimate contains the result.
  const int kNextEpoch = kSearchInterval + OdometrySettings{}.tracking.search_again + 1;
  const double pitch = 0.55 * kRadiansPerDegree;
  const auto estimates = estimated(lostWith({.pitch = pitch}, kNextEpoch + 1)).estimates;
  for (const OdometryEstimate& estimate : estimates)
    EXPECT_FALSE(estimate.valid);
  for (int i = 0; i < kSearchInterval; ++i)
    EXPECT_EQ(estimates[i].rig->pitch.value, 0.0) << i;
  EXPECT_NEAR(estimates[kNextEpoch].rig->pitch.value, pitch, kTolerance)
      << "and the pitch is kept until then";
}

TEST(RigCalibrationError, FindsAPitchAfterTheRightCameraWasCovered) {
  std::vector<StereoImages> pairs = drivenWith({.pitch = 0.5 * kRadiansPerDegree}, 0.0, 4);
  pairs.front().right = cv::Mat(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(100));
  EXPECT_NEAR(estimated(pairs).error.pitch.value, 0.5 * kRadiansPerDegree, kTolerance);
}

TEST(RigCalibrationError, FindsTheDelayOfTheRightCamera) {
  for (const double late : {-0.003, 0.003}) {
    const RigCalibrationError error = driven({}, late).error;
    EXPECT_NEAR(error.delay.value, late, 0.001);
    EXPECT_LT(error.delay.stddev, 0.001);
  }
}

TEST(RigCalibration, CorrectsSignificantAnglesUpToALimit) {
  const SelfCalibrationSettings settings;
  const double limit = settings.maximum_rotation;
  RigCalibration rig(settings);
  rig.set({{1e-3, 2e-3}, {-2.0 * limit, 1e-5}, {2e-3, 1e-3}, {0.0, 1e-3}});
  const RigCorrection correction = rig.correction();
  EXPECT_EQ(correction.pitch, 0.0) << "below its deviation";
  EXPECT_EQ(correction.yaw, -limit);
  EXPECT_NEAR(correction.roll, 2e-3 - 1e-3 * 1e-3 / 2e-3, 1e-12);
  EXPECT_EQ(rig.expected().pitch, 1e-3) << "the search for matches follows the estimate";
  EXPECT_GT(rig.error().yaw.stddev, settings.uncorrected_yaw_share * 0.9 * limit) << "depths are wrong";
  EXPECT_NEAR(rig.error().observability.roll, 1.0 - 1.0 / 9.0, 1e-12);
}

TEST(RigCalibration, KeepsAYawUntilAnotherIsMeasured) {
  RigCalibration rig;
  rig.set({{}, {1e-3, 1e-4}, {}, {}});
  rig.set({{}, {5e-3, 1e-3}, {}, {}});
  EXPECT_EQ(rig.states().yaw.value, 1e-3);
}

TEST(RigCalibration, KnowsLittleOfTheOtherAnglesAfterABump) {
  const SelfCalibrationSettings settings;
  RigCalibration rig(settings);
  rig.set({{1e-3, 1e-5}, {1e-3, 1e-5}, {1e-3, 1e-5}, {}});
  rig.reinitialisePitch({4e-3, 1e-4});
  EXPECT_EQ(rig.states().pitch.value, 4e-3);
  EXPECT_NEAR(rig.states().roll.stddev, settings.calibration_stddev, 1e-6);
  EXPECT_NEAR(rig.states().yaw.stddev, settings.calibration_stddev, 1e-6);
}

TEST(RigCalibrationError, IsEmptyWithoutRigRefinement) {
  OdometrySettings settings;
  settings.rig_refinement = RigRefinement::off;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  for (const StereoImages& pair : drivenWith({}, 0.0, 2))
    EXPECT_FALSE(odometry.process(pair, observer).rig.has_value());
}

TEST(RigCalibrationError, FindsNoErrorOfACorrectRig) {
  const RigCalibrationError error = driven({}, 0.0).error;
  for (const EstimateWithStddev& angle : {error.pitch, error.yaw, error.roll})
    EXPECT_LT(std::abs(angle.value), kTolerance);
  EXPECT_LT(std::abs(error.delay.value), 0.5e-3);
}

}  // namespace
}  // namespace cartvo::vo
