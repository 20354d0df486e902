// Tests of the weight of measurements in fixed poses, which have errors.
#include <cmath>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/estimation/bundle_adjustment.hpp"

namespace cartvo::vo {
namespace {

/// RMS relative error of the depths over twenty scenes. Fixed poses have `pose_error` times the usual error
/// of a motion; left positions in their pairs have the factor `weight`.
double depthError(double pose_error, double weight) {
  constexpr double kTranslation = 2e-3, kRotation = 1e-4;  // m and rad
  double squares = 0.0;
  int count = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    test::Noise random(static_cast<std::uint64_t>(seed));
    BundleProblem problem = test::simulateProblem({.noise = 1.0}, static_cast<std::uint64_t>(seed));
    const BundleProblem truth = test::simulateProblem({}, static_cast<std::uint64_t>(seed));
    problem.fixed_pose_weight = weight;
    for (int i = 0; i < problem.fixed; ++i) {
      Vector6d error;
      for (int axis = 0; axis < 6; ++axis)
        error[axis] = pose_error * (axis < 3 ? kTranslation : kRotation) * random.gaussian();
      problem.poses[i].T_world_camera = problem.poses[i].T_world_camera * motionFromVector(error);
    }
    EXPECT_TRUE(test::adjustBundle(problem, BundleSettings{}).converged);
    for (std::size_t i = 0; i < truth.landmarks.size(); ++i, ++count)
      squares += std::pow(problem.landmarks[i].inverse_depth / truth.landmarks[i].inverse_depth - 1.0, 2);
  }
  return std::sqrt(squares / count);
}

TEST(FixedPoses, ErrorsDoLessHarmWithALowerWeight) {
  EXPECT_LT(depthError(3.0, 0.2), 0.9 * depthError(3.0, 1.0));
}

TEST(FixedPoses, ExactPosesGiveBestDepthsWithFullWeight) {
  EXPECT_LT(depthError(0.0, 1.0), depthError(0.0, 0.2));
}

TEST(FixedPoses, DefaultWeightIsOne) {
  EXPECT_EQ(depthError(3.0, BundleProblem{}.fixed_pose_weight), depthError(3.0, 1.0));
}

}  // namespace
}  // namespace cartvo::vo
