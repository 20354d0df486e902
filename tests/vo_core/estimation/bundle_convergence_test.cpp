// Tests of the convergence criterion of the bundle adjustment.
#include <Eigen/LU>
#include <cmath>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/estimation/bundle_adjustment.hpp"

namespace cartvo::vo {
namespace {

TEST(BundleConvergence, EndsWithinAFifthOfAStddevOfTheMinimum) {
  for (int seed = 1; seed <= 5; ++seed) {
    BundleProblem problem = test::simulateProblem({.offset = 0.02, .noise = 1.0}, seed);
    test::disturb(problem);
    BundleProblem minimum = problem;
    const BundleResult result = test::adjustBundle(problem, BundleSettings{});
    ASSERT_TRUE(result.converged);
    ASSERT_TRUE(test::adjustBundle(minimum, {.iterations = 20, .convergence = 0.0}).converged);
    const Vector6d apart =
        vectorFromMotion(minimum.poses.back().T_world_camera.inverse() * problem.poses.back().T_world_camera);
    EXPECT_LT(std::sqrt(apart.dot(result.covariance.inverse() * apart) / 6.0), 0.2) << seed;
    EXPECT_GT(apart.norm(), 0.0) << seed;
  }
}

}  // namespace
}  // namespace cartvo::vo
