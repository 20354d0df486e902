// Tests of the odometry with images in which a part does not move with the scene.
#include "vo_core/integrity/still_regions.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "support/vo_core/still_overlay.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr double kStep = 0.1;                 // m per pair
constexpr int kPairs = 40;
const cv::Rect kBonnet(60, 160, 280, 64);
constexpr int kDisparity = 40;  // px, of the bonnet: 1.3 m before both cameras

/// Settings for a rig that is right.
OdometrySettings settingsOfTheRig() {
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;
  return settings;
}

/// Estimates of a straight drive.
std::vector<OdometryEstimate> driven(bool with_bonnet) {
  static const test::CorridorWorld world(1);
  StereoOdometry odometry(kCamera, settingsOfTheRig());
  NullStageObserver observer;
  std::vector<OdometryEstimate> estimates;
  for (int i = 0; i < kPairs; ++i) {
    const Eigen::Isometry3d pose(Eigen::Translation3d(0.0, 0.0, kStep * i));
    StereoImages images = world.render(kCamera, pose, i * kPeriod);
    if (with_bonnet) test::drawStillOverlay(images, kBonnet, kDisparity);
    estimates.push_back(odometry.process(images, observer));
  }
  return estimates;
}

TEST(StillRegions, AreTheOnesThatDoNotMoveWithTheScene) {
  const auto estimates = driven(true);
  ASSERT_FALSE(estimates.back().still_regions.empty());
  const ImageRegion& region = estimates.back().still_regions.front();
  const cv::Rect found(region.x, region.y, region.width, region.height);
  EXPECT_GT((found & kBonnet).area(), 0.4 * kBonnet.area());
  EXPECT_GT((found & kBonnet).area(), 0.8 * found.area());
  for (int i = 2; i < kPairs; ++i) {
    EXPECT_TRUE(estimates[i].valid) << i;
    EXPECT_NEAR(estimates[i].T_previous_current.translation().z(), kStep, 0.05 * kStep) << i;
  }
}

TEST(StillRegions, AreAbsentFromAnUnobstructedView) {
  for (const OdometryEstimate& estimate : driven(false))
    EXPECT_TRUE(estimate.still_regions.empty());
}

/// Where hardly any landmark is found in the right image, those that are may be so by chance, as between hot
/// pixels of a dark night: they are not asked how far the cart goes.
TEST(StereoMatches, AreNeededByAFifthOfTheLandmarks) {
  static const test::CorridorWorld world(1);
  StereoOdometry odometry(kCamera, settingsOfTheRig());
  NullStageObserver observer;
  const int shown = kCamera.height / 10;  // px, upper part of the right image
  for (int i = 0; i < kPairs; ++i) {
    const Eigen::Isometry3d pose(Eigen::Translation3d(0.0, 0.0, kStep * i));
    StereoImages images = world.render(kCamera, pose, i * kPeriod);
    if (i > 4) images.right.rowRange(shown, kCamera.height).setTo(90);
    const bool valid = odometry.process(images, observer).valid;
    if (i > 0 && i < 6) {
      EXPECT_TRUE(valid) << i;
    } else if (i > 30) {
      EXPECT_FALSE(valid) << i;
    }
  }
}

/// A departure with a part of the cart in view, which fits the standstill, as the far end of the corridor
/// does: pairs may be INVALID until the landmarks of the stand show the motion, and no way is lost.
class PartOfTheCartInView : public testing::TestWithParam<double> {};

TEST_P(PartOfTheCartInView, HidesNoDeparture) {
  constexpr int kStand = 10, kDriven = 10;  // pairs
  constexpr double kTolerance = 0.006;      // m, about a pixel of flow of the walls
  static const test::CorridorWorld world(1);
  OdometrySettings settings;
  settings.features = 400;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  int valid = 0;
  for (int i = 0; i < kStand + kDriven; ++i) {
    const double time = 1e-9 * kPeriod * std::max(i - kStand, 0);
    const double way = 0.5 * GetParam() * time * time;
    StereoImages images =
        world.render(kCamera, Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, way)), i * kPeriod);
    test::drawStillOverlay(images, kBonnet, kDisparity);
    const OdometryEstimate estimate = odometry.process(images, observer);
    EXPECT_EQ(estimate.reset_counter, 0) << i;
    if (!estimate.valid) continue;
    ++valid;
    EXPECT_NEAR(estimate.T_world_camera.translation().z(), way, kTolerance) << i;
  }
  EXPECT_GE(valid, kStand + kDriven - 4);  // the first pair, and three of the departure
}

INSTANTIATE_TEST_SUITE_P(Accelerations, PartOfTheCartInView, testing::Values(1.0, 3.0));  // m/s^2

}  // namespace
}  // namespace cartvo::vo
