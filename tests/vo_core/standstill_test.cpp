// When a cart is taken to stand.
#include "vo_core/standstill.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/rigid_motion.hpp"
#include "vo_core/synthetic_texture.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kPeriod = 55'000'000;  // ns
const StandstillSettings kSettings{.translation = 0.0015, .rotation = 0.0002, .least_time = 0.25};

Eigen::Isometry3d poseOf(double z, double yaw) {
  Vector6d vector = Vector6d::Zero();
  vector[2] = z;
  vector[4] = yaw;
  return motionFromVector(vector);
}

/// Which of 40 pairs stand, at poses that are functions of the time in seconds.
template <typename Pose>
std::vector<bool> standing(const Pose& pose) {
  StandstillDetector detector(kSettings);
  std::vector<bool> stands;
  for (int i = 0; i < 40; ++i)
    stands.push_back(detector.stands(pose(1e-9 * static_cast<double>(i * kPeriod)), i * kPeriod));
  return stands;
}

int count(const std::vector<bool>& stands) {
  return static_cast<int>(std::count(stands.begin(), stands.end(), true));
}

TEST(Standstill, BeginsOnceThePoseHasStayedLongEnough) {
  const auto stands = standing([](double) { return poseOf(7.0, 1.0); });
  for (int i = 0; i < 40; ++i)
    EXPECT_EQ(stands[i], i >= 5) << i;  // 5 * 55 ms are the first 0.25 s
}

TEST(Standstill, IsNotDisturbedByAPosesNoise) {
  test::Noise noise(1);
  const auto stands =
      standing([&](double) { return poseOf(2e-4 * noise.gaussian(), 2e-5 * noise.gaussian()); });
  EXPECT_EQ(count(stands), 35);
}

TEST(Standstill, IsNotASlowDrive) {
  EXPECT_EQ(count(standing([](double t) { return poseOf(0.03 * t, 0.0); })), 0);
}

TEST(Standstill, IsNotATurnOnTheSpot) {
  EXPECT_EQ(count(standing([](double t) { return poseOf(0.0, -0.004 * t); })), 0);
}

TEST(Standstill, EndsWithTheFirstPairThatMoves) {
  const auto stands = standing([](double t) { return poseOf(t < 1.0 ? 0.0 : 0.1 * (t - 1.0), 0.0); });
  EXPECT_TRUE(stands[18]);   // 0.99 s
  EXPECT_FALSE(stands[19]);  // 4.5 mm on
  EXPECT_FALSE(stands[39]);
}

TEST(Standstill, BeginsAnewAfterAMove) {
  const auto stands = standing([](double t) { return poseOf(t < 1.0 ? 0.0 : 0.5, 0.0); });
  EXPECT_TRUE(stands[18]);
  for (int i = 19; i < 24; ++i)
    EXPECT_FALSE(stands[i]) << i;
  EXPECT_TRUE(stands[24]);
}

TEST(Standstill, AMotionIsBeyondAStandByItsTranslationOrItsRotation) {
  const StandstillDetector detector(kSettings);
  EXPECT_FALSE(detector.beyond(Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(detector.beyond(poseOf(0.0014, 0.00019)));
  EXPECT_TRUE(detector.beyond(poseOf(-0.0016, 0.0)));
  EXPECT_TRUE(detector.beyond(poseOf(0.0, -0.00021)));
}

}  // namespace
}  // namespace cartvo
