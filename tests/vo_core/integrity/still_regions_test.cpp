// Tests of the odometry with images in which a part does not move with the scene.
#include "vo_core/integrity/still_regions.hpp"

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

/// Estimates of a straight drive.
std::vector<OdometryEstimate> driven(bool with_bonnet) {
  static const test::CorridorWorld world(1);
  OdometrySettings settings;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;
  StereoOdometry odometry(kCamera, settings);
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

}  // namespace
}  // namespace cartvo::vo
