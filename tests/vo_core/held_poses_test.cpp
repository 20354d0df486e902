// Free poses that are held where they start.
#include <Eigen/LU>

#include <gtest/gtest.h>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;

constexpr double kPlain = 1e6;  // width of a robust weight that is always one

/// Two free poses whose first is believed to be off by `away`, with so much information.
BundleProblem heldAway(const Vector6d& away, double information) {
  BundleProblem problem = test::seenBy({.free_frames = 2}, 1);
  TimedPose& pose = problem.poses[5];
  pose.T_world_camera = pose.T_world_camera * motionFromVector(away);
  for (int i = 0; i < 6; ++i)
    problem.held.push_back(information * Matrix6d::Identity());
  return problem;
}

TEST(HeldPoses, AHeldPoseMovesAsFarAsItIsWorthAgainstWhatIsSeen) {
  const Vector6d away = test::vector6(2e-3, -1e-3, 3e-3, 1e-4, -2e-4, 1e-4);
  const BundleSettings settings{.iterations = 20, .convergence = 0.0, .robust_width = kPlain};
  BundleProblem free = heldAway(away, 0.0);
  const BundleResult by_sight = test::adjustBundle(free, settings);
  EXPECT_LT(test::poseErrors(free).norm(), 1e-6) << "no information";
  BundleProblem nailed = heldAway(away, 1e12);
  ASSERT_TRUE(test::adjustBundle(nailed, settings).converged);
  EXPECT_LT((test::poseErrors(nailed).head<6>() - away).norm(), 1e-5) << "all that there is";

  // In between, as two measurements are weighed: by the inverse covariance of what is seen and by that of the
  // start. The step is linear, the errors small.
  constexpr double kInformation = 1e6;
  BundleProblem held = heldAway(away, kInformation);
  const BundleResult result = test::adjustBundle(held, settings);
  const Matrix6d seen = by_sight.covariance.topLeftCorner<6, 6>().inverse();
  const Matrix6d start = kInformation * Matrix6d::Identity();
  const Vector6d expected = (seen + start).inverse() * start * away;
  EXPECT_LT((test::poseErrors(held).head<6>() - expected).norm(), 0.01 * expected.norm());
  const Matrix6d covariance = result.covariance.topLeftCorner<6, 6>();
  EXPECT_LT((covariance - (seen + start).inverse()).norm(), 0.01 * covariance.norm());
}

TEST(HeldPoses, PassesOnWhatLateRightCamerasDidToAHeldPose) {
  constexpr double kDelay = 1e-5;
  const Vector6d by_late_right = test::vector6(0.3, -0.1, 0.4, 0.02, 0.05, -0.01);
  const BundleSettings settings{.iterations = 10, .convergence = 0.0, .robust_width = kPlain};
  BundleProblem late = heldAway(kDelay * by_late_right, 1e6);
  for (TimedPose& pose : late.poses)
    pose.offset -= kDelay;
  late.poses[5].by_late_right = by_late_right;
  ASSERT_TRUE(test::adjustBundle(late, settings).converged);
  const Vector12d expected = test::poseErrors(late) / kDelay;
  Vector12d said;
  said << late.poses[5].by_late_right, late.poses[6].by_late_right;
  EXPECT_GT(expected.norm(), 0.1);
  EXPECT_LT((said - expected).norm(), 0.01 * expected.norm());
}

}  // namespace
}  // namespace cartvo
