// What is told against poses that stand in the window, but err.
#include <cmath>

#include <gtest/gtest.h>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

/// Relative error of the depths, root mean square over twenty scenes. Standing poses are off by `away` times
/// what a motion usually errs by, and left positions in their pairs have that share of their weight.
double depthError(double away, double share) {
  constexpr double kTranslation = 2e-3, kRotation = 1e-4;  // m and rad
  double squares = 0.0;
  int count = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    test::Noise random(static_cast<std::uint64_t>(seed));
    BundleProblem problem = test::seenBy({.noise = 1.0}, static_cast<std::uint64_t>(seed));
    const BundleProblem truth = test::seenBy({}, static_cast<std::uint64_t>(seed));
    problem.standing_share = share;
    for (int i = 0; i < problem.fixed; ++i) {
      Vector6d error;
      for (int axis = 0; axis < 6; ++axis)
        error[axis] = away * (axis < 3 ? kTranslation : kRotation) * random.gaussian();
      problem.poses[i].T_world_camera = problem.poses[i].T_world_camera * motionFromVector(error);
    }
    EXPECT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
    for (std::size_t i = 0; i < truth.landmarks.size(); ++i, ++count)
      squares += std::pow(problem.landmarks[i].inverse_depth / truth.landmarks[i].inverse_depth - 1.0, 2);
  }
  return std::sqrt(squares / count);
}

TEST(StandingPoses, ThatErrMisleadLessIfLessIsToldAgainstThem) {
  EXPECT_LT(depthError(3.0, 0.2), 0.9 * depthError(3.0, 1.0));
}

TEST(StandingPoses, ThatAreExactAreWorthTheirFullWeight) {
  EXPECT_LT(depthError(0.0, 1.0), depthError(0.0, 0.2));
}

TEST(StandingPoses, ShareIsOneUnlessSaidOtherwise) {
  EXPECT_EQ(depthError(3.0, BundleProblem{}.standing_share), depthError(3.0, 1.0));
}

}  // namespace
}  // namespace cartvo
