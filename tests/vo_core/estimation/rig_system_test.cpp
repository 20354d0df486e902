// Tests of the normal equations of the rig calibration and of the window's scale.
#include <Eigen/Cholesky>
#include <cmath>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/estimation/bundle_adjustment.hpp"

namespace cartvo::vo {
namespace {

TEST(RigSystem, EstimatesTheScaleVarianceOfDisparities) {
  // A window with a single fixed pose has no other source of scale than disparities.
  BundleProblem open = test::simulateProblem({.free_frames = 6}, 1);
  const BundleResult by_disparities = test::adjustBundle(open, BundleSettings{});
  const Eigen::Isometry3d way =
      open.poses.front().T_world_camera.inverse() * open.poses.back().T_world_camera;
  const Eigen::Vector3d along = (way.linear().transpose() * way.translation()).normalized();
  const Matrix6d newest = by_disparities.covariance.bottomRightCorner<6, 6>();
  const double variance = along.dot(newest.topLeftCorner<3, 3>() * along) / way.translation().squaredNorm();

  BundleProblem fixed_poses = test::simulateProblem({}, 1);
  const BundleResult result = test::adjustBundle(fixed_poses, BundleSettings{});
  EXPECT_NEAR(std::sqrt(result.scale_variance), std::sqrt(variance), 0.2 * std::sqrt(variance));

  for (BundleLandmark& landmark : fixed_poses.landmarks)
    for (BundleObservation& observation : landmark.observations)
      observation.stereo = false;
  EXPECT_DOUBLE_EQ(std::sqrt(test::adjustBundle(fixed_poses, BundleSettings{}).scale_variance), 0.05)
      << "unobserved scale";
}

TEST(RigSystem, GradientIsInformationTimesError) {
  const RigCorrection rig{1e-5, -2e-5};
  for (const double offset : {-0.02, 0.0, 0.02}) {
    BundleProblem problem =
        test::simulateProblem({.free_frames = 3, .landmarks = 20, .offset = offset, .rig = rig}, 1);
    const BundleResult result =
        test::adjustBundle(problem, {.iterations = 10, .convergence = 0.0, .robust_width = 1e6});
    const RigCorrection::Vector found = result.rig_information.ldlt().solve(result.rig_gradient);
    EXPECT_NEAR(found[0], rig.yaw, 1e-7) << offset;
    EXPECT_NEAR(found[1], rig.p2, 2e-7) << offset;
  }
}

}  // namespace
}  // namespace cartvo::vo
