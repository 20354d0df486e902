// Tests of the detection of a standstill.
#include "vo_core/integrity/standstill.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {
namespace {

constexpr std::int64_t kPeriod = 55'000'000;  // ns
const StandstillSettings kSettings{.translation = 0.0015, .rotation = 0.0002, .least_time = 0.25};

Eigen::Isometry3d poseOf(double z, double yaw) {
  Vector6d vector = Vector6d::Zero();
  vector[2] = z;
  vector[4] = yaw;
  return motionFromVector(vector);
}

/// Standstill of 40 pairs, whose poses are a function of the time in seconds.
template <typename Pose>
std::vector<bool> standing(const Pose& pose) {
  StandstillDetector detector(kSettings);
  std::vector<bool> stands;
  for (int i = 0; i < 40; ++i)
    stands.push_back(detector.update(pose(1e-9 * static_cast<double>(i * kPeriod)), i * kPeriod));
  return stands;
}

int count(const std::vector<bool>& stands) {
  return static_cast<int>(std::count(stands.begin(), stands.end(), true));
}

TEST(StandstillDetector, DetectsAStandstillAfterTheMinimumTime) {
  const auto stands = standing([](double) { return poseOf(7.0, 1.0); });
  for (int i = 0; i < 40; ++i)
    EXPECT_EQ(stands[i], i >= 5) << i;  // 5 * 55 ms is the first multiple beyond 0.25 s
}

TEST(StandstillDetector, ToleratesNoiseOfThePose) {
  test::Noise noise(1);
  const auto stands =
      standing([&](double) { return poseOf(2e-4 * noise.gaussian(), 2e-5 * noise.gaussian()); });
  EXPECT_EQ(count(stands), 35);
}

TEST(StandstillDetector, RejectsASlowDrive) {
  EXPECT_EQ(count(standing([](double t) { return poseOf(0.03 * t, 0.0); })), 0);
}

TEST(StandstillDetector, RejectsATurnOnTheSpot) {
  EXPECT_EQ(count(standing([](double t) { return poseOf(0.0, -0.004 * t); })), 0);
}

TEST(StandstillDetector, EndsWithTheFirstMotion) {
  const auto stands = standing([](double t) { return poseOf(t < 1.0 ? 0.0 : 0.1 * (t - 1.0), 0.0); });
  EXPECT_TRUE(stands[18]);   // 0.99 s
  EXPECT_FALSE(stands[19]);  // after 4.5 mm
  EXPECT_FALSE(stands[39]);
}

TEST(StandstillDetector, RestartsTheMinimumTimeAfterAMove) {
  const auto stands = standing([](double t) { return poseOf(t < 1.0 ? 0.0 : 0.5, 0.0); });
  EXPECT_TRUE(stands[18]);
  for (int i = 19; i < 24; ++i)
    EXPECT_FALSE(stands[i]) << i;
  EXPECT_TRUE(stands[24]);
}

TEST(StandstillDetector, MotionExceedsLimitsByTranslationOrRotation) {
  const StandstillDetector detector(kSettings);
  EXPECT_FALSE(detector.exceedsLimits(Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(detector.exceedsLimits(poseOf(0.0014, 0.00019)));
  EXPECT_TRUE(detector.exceedsLimits(poseOf(-0.0016, 0.0)));
  EXPECT_TRUE(detector.exceedsLimits(poseOf(0.0, -0.00021)));
}

}  // namespace
}  // namespace cartvo::vo
