// What a window's disparities tell of its scale.
#include <cmath>

#include <gtest/gtest.h>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

TEST(RigSystem, SaysHowWellDisparitiesTellTheScale) {
  // A window of which nothing stands but its first pose has no scale but what disparities tell.
  BundleProblem open = test::seenBy({.free_frames = 6}, 1);
  const BundleResult by_disparities = test::adjustBundle(open, BundleSettings{});
  const Eigen::Isometry3d way =
      open.poses.front().T_world_camera.inverse() * open.poses.back().T_world_camera;
  const Eigen::Vector3d along = (way.linear().transpose() * way.translation()).normalized();
  const Matrix6d newest = by_disparities.covariance.bottomRightCorner<6, 6>();
  const double variance = along.dot(newest.topLeftCorner<3, 3>() * along) / way.translation().squaredNorm();

  BundleProblem standing = test::seenBy({}, 1);
  const BundleResult result = test::adjustBundle(standing, BundleSettings{});
  EXPECT_NEAR(std::sqrt(result.scale_variance), std::sqrt(variance), 0.2 * std::sqrt(variance));

  for (BundleLandmark& landmark : standing.landmarks)
    for (BundleSighting& sighting : landmark.sightings)
      sighting.stereo = false;
  EXPECT_DOUBLE_EQ(std::sqrt(test::adjustBundle(standing, BundleSettings{}).scale_variance), 0.05)
      << "nothing tells it";
}

}  // namespace
}  // namespace cartvo
