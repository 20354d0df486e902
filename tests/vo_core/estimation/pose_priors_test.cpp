// Tests of priors on free poses.
#include <Eigen/LU>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/estimation/bundle_adjustment.hpp"

namespace cartvo::vo {
namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;

constexpr double kNoRobustWidth = 1e6;  // robust width at which every weight is one

/// Problem with two free poses; the prior of the first has the error `error` and this information.
BundleProblem withPriorError(const Vector6d& error, double information) {
  BundleProblem problem = test::simulateProblem({.free_frames = 2}, 1);
  TimedPose& pose = problem.poses[5];
  pose.T_world_camera = pose.T_world_camera * motionFromVector(error);
  for (int i = 0; i < 6; ++i)
    problem.pose_prior_information.push_back(information * Matrix6d::Identity());
  return problem;
}

TEST(PosePriors, WeightsPriorAndMeasurementsByInformation) {
  const Vector6d error = test::vector6(2e-3, -1e-3, 3e-3, 1e-4, -2e-4, 1e-4);
  const BundleSettings settings{.iterations = 20, .convergence = 0.0, .robust_width = kNoRobustWidth};
  BundleProblem free = withPriorError(error, 0.0);
  const BundleResult without_prior = test::adjustBundle(free, settings);
  EXPECT_LT(test::poseErrors(free).norm(), 1e-6) << "no information";
  BundleProblem fixed = withPriorError(error, 1e12);
  ASSERT_TRUE(test::adjustBundle(fixed, settings).converged);
  EXPECT_LT((test::poseErrors(fixed).head<6>() - error).norm(), 1e-5) << "dominant prior";

  // In between, the result is the weighted mean of the measurements and the prior. The errors are small, so
  // the step is linear.
  constexpr double kInformation = 1e6;
  BundleProblem weighted = withPriorError(error, kInformation);
  const BundleResult result = test::adjustBundle(weighted, settings);
  const Matrix6d measured = without_prior.covariance.topLeftCorner<6, 6>().inverse();
  const Matrix6d start = kInformation * Matrix6d::Identity();
  const Vector6d expected = (measured + start).inverse() * start * error;
  EXPECT_LT((test::poseErrors(weighted).head<6>() - expected).norm(), 0.01 * expected.norm());
  const Matrix6d covariance = result.covariance.topLeftCorner<6, 6>();
  EXPECT_LT((covariance - (measured + start).inverse()).norm(), 0.01 * covariance.norm());
}

TEST(PosePriors, PropagatesTimeOffsetSensitivityOfThePrior) {
  constexpr double kDelay = 1e-5;
  const Vector6d dpose_doffset = test::vector6(0.3, -0.1, 0.4, 0.02, 0.05, -0.01);
  const BundleSettings settings{.iterations = 10, .convergence = 0.0, .robust_width = kNoRobustWidth};
  BundleProblem late = withPriorError(kDelay * dpose_doffset, 1e6);
  for (TimedPose& pose : late.poses)
    pose.offset -= kDelay;
  late.poses[5].dpose_doffset = dpose_doffset;
  ASSERT_TRUE(test::adjustBundle(late, settings).converged);
  const Vector12d expected = test::poseErrors(late) / kDelay;
  Vector12d reported;
  reported << late.poses[5].dpose_doffset, late.poses[6].dpose_doffset;
  EXPECT_GT(expected.norm(), 0.1);
  EXPECT_LT((reported - expected).norm(), 0.01 * expected.norm());
}

}  // namespace
}  // namespace cartvo::vo
