// What driving tells of a right camera that is turned or late: images in, errors out.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/corridor_world.hpp"
#include "vo_core/rig_correction.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr double kPeriod = 0.05;  // s
constexpr double kDegree = M_PI / 180.0;
constexpr double kTolerance = 0.03 * kDegree;
constexpr double kLightByNight = 0.16, kNoiseByNight = 2.0;  // of the day's, and grey values
constexpr int kFeatures = 400, kFeaturesByNight = 1000;
constexpr int kPairs = 16;

/// 3 m/s, swinging from side to side and nodding.
Eigen::Isometry3d drive(double time) {
  Vector6d vector;
  vector << 0.0, 0.02 * std::sin(6.0 * time), 3.0 * time, 0.02 * std::sin(8.0 * time),
      0.1 * std::sin(3.0 * time), 0.0;
  return motionFromVector(vector);
}

/// What the left camera sees, rendered once.
const cv::Mat& leftImage(const test::CorridorWorld& world, int i) {
  static const std::vector<cv::Mat> images = [&world] {
    std::vector<cv::Mat> rendered;
    for (int frame = 0; frame < kPairs; ++frame)
      rendered.push_back(world.view(kCamera, drive(frame * kPeriod)));
    return rendered;
  }();
  return images[i];
}

/// What both cameras say they see, the right one turned by `turned` and exposed `late` s later than it says.
std::vector<StereoImages> drivenWith(const RigCorrection& turned, double late, int count) {
  const test::CorridorWorld world(1);
  std::vector<StereoImages> pairs;
  for (int i = 0; i < count; ++i) {
    const double time = i * kPeriod;
    Eigen::Isometry3d right = drive(time + late) * Eigen::Translation3d(kCamera.baseline, 0.0, 0.0);
    right.rotate(turned.rotation());
    const std::int64_t stamp = std::llround(1e9 * time);
    pairs.push_back({leftImage(world, i), world.view(kCamera, right), stamp, stamp});
  }
  return pairs;
}

struct Driven {
  RigCheck check;
  double path = 0.0;  ///< m, of what was estimated
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
    result.check = estimate.rig.value_or(RigCheck{});
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

TEST(RigCheck, FindsAndCorrectsARightCameraThatIsTurned) {
  const RigCorrection turned{.pitch = 0.3 * kDegree, .roll = -0.3 * kDegree};
  const Driven result = driven(turned, 0.0);
  EXPECT_NEAR(result.check.pitch.value, turned.pitch, kTolerance);
  EXPECT_NEAR(result.check.roll.value, turned.roll, kTolerance);
  EXPECT_NEAR(result.check.yaw.value, 0.0, kTolerance);
  EXPECT_NEAR(result.path, kTruePath, 0.03 * kTruePath);
}

TEST(RigCheck, FindsAPitchThatHidesNearlyAllMatches) {
  // 0.5 degrees: 2.3 px, farther than rows are searched.
  const Driven result = driven({.pitch = -0.5 * kDegree}, 0.0);
  EXPECT_NEAR(result.check.pitch.value, -0.5 * kDegree, kTolerance);
  EXPECT_NEAR(result.path, kTruePath, 0.03 * kTruePath);
}

TEST(RigCheck, FindsMostOfAYawWithinThreeMetres) {
  const double yaw = -0.3 * kDegree;
  const RigCheck check = driven({.yaw = yaw}, 0.0).check;
  EXPECT_LT(check.yaw.value, 0.6 * yaw);
  EXPECT_GT(check.yaw.value, 1.1 * yaw);
}

/// The same drive by night: a sixth of the light, and the cameras' noise.
std::vector<StereoImages> byNight(std::vector<StereoImages> pairs) {
  cv::RNG random(7);
  for (StereoImages& pair : pairs)
    for (cv::Mat* image : {&pair.left, &pair.right}) {
      cv::Mat noise(image->size(), CV_16SC1), dark;
      random.fill(noise, cv::RNG::NORMAL, 0.0, kNoiseByNight);
      image->convertTo(dark, CV_16SC1, kLightByNight, 16.0);
      cv::Mat night;  // the day's image is used again
      cv::Mat(dark + noise).convertTo(night, CV_8UC1);
      *image = night;
    }
  return pairs;
}

TEST(RigCheck, FindsAPitchByNightWhereFewMatchAnyway) {
  const auto pairs = byNight(drivenWith({.pitch = 0.5 * kDegree}, 0.0, kPairs));
  const Driven corrected = estimated(pairs, kFeaturesByNight);
  EXPECT_NEAR(corrected.check.pitch.value, 0.5 * kDegree, kTolerance);
  EXPECT_NEAR(corrected.path, kTruePath, 0.1 * kTruePath);
}

TEST(RigCheck, FindsNothingWrongByNight) {
  const auto pairs = byNight(drivenWith({}, 0.0, kPairs));
  EXPECT_NEAR(estimated(pairs, kFeaturesByNight).check.pitch.value, 0.0, kTolerance);
}

/// Each pair from another world, so that no motion is found; the right camera is turned and, at the first
/// pair, covered.
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

TEST(RigCheck, WhileLostLooksForAPitchAtEachTwentiethPair) {
  constexpr int kLooksAgain = 20;
  // The pair by which an epoch has begun since: its estimate tells what was found.
  const int kNextEpoch = kLooksAgain + OdometrySettings{}.tracking.search_again + 1;
  const double pitch = 0.55 * kDegree;
  const auto estimates = estimated(lostWith({.pitch = pitch}, kNextEpoch + 1)).estimates;
  for (const OdometryEstimate& estimate : estimates)
    EXPECT_FALSE(estimate.valid);
  for (int i = 0; i < kLooksAgain; ++i)
    EXPECT_EQ(estimates[i].rig->pitch.value, 0.0) << i;
  EXPECT_NEAR(estimates[kNextEpoch].rig->pitch.value, pitch, kTolerance) << "nor is it forgotten until then";
}

TEST(RigCheck, FindsAPitchSoonThoughTheRightCameraWasCoveredAtFirst) {
  std::vector<StereoImages> pairs = drivenWith({.pitch = 0.5 * kDegree}, 0.0, 4);
  pairs.front().right = cv::Mat(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(100));
  EXPECT_NEAR(estimated(pairs).check.pitch.value, 0.5 * kDegree, kTolerance);
}

TEST(RigCheck, FindsARightCameraThatIsLateOrEarly) {
  for (const double late : {-0.003, 0.003}) {
    const RigCheck check = driven({}, late).check;
    EXPECT_NEAR(check.delay.value, late, 0.001);
    EXPECT_LT(check.delay.deviation, 0.001);
  }
}

TEST(RigCheck, IsNotThereWhereTheRigIsNotRefined) {
  OdometrySettings settings;
  settings.rig_refinement = RigRefinement::off;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  for (const StereoImages& pair : drivenWith({}, 0.0, 2))
    EXPECT_FALSE(odometry.process(pair, observer).rig.has_value());
}

TEST(RigCheck, FindsNothingWrongWithARigInOrder) {
  const RigCheck check = driven({}, 0.0).check;
  for (const Checked& angle : {check.pitch, check.yaw, check.roll})
    EXPECT_LT(std::abs(angle.value), kTolerance);
  EXPECT_LT(std::abs(check.delay.value), 0.5e-3);
}

}  // namespace
}  // namespace cartvo
