// Tests of the noise estimated from the residuals of a bundle adjustment.
#include "vo_core/estimation/bundle_noise.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

TEST(BundleNoise, EstimatesTheRatioToTheAssumedNoise) {
  for (const double noise : {0.5, 1.0, 2.0}) {
    BundleProblem problem = test::simulateProblem({.landmarks = 400, .noise = noise}, 3);
    const BundleResult result = test::adjustBundle(problem, BundleSettings{});
    EXPECT_NEAR(result.noise_scale.front().pixel, noise, 0.15 * noise);
    EXPECT_NEAR(result.noise_scale.front().disparity, noise, 0.15 * noise);
  }
}

TEST(BundleNoise, AdaptsEachLevelSeparately) {
  BundleProblem problem = test::simulateProblem({.landmarks = 800, .noise = 0.7, .coarse_noise = 2.5}, 4);
  BundleNoises noise = problem.noise;
  for (int pair = 0; pair < 40; ++pair) {
    const BundleResult result = test::adjustBundle(problem, BundleSettings{});
    EXPECT_NEAR(result.noise_scale[0].pixel * problem.noise[0].pixel, 0.7 * noise[0].pixel,
                0.1 * noise[0].pixel);
    problem.noise = adapted(problem.noise, result, 10.0);
  }
  EXPECT_NEAR(problem.noise[0].pixel, 0.7 * noise[0].pixel, 0.1 * noise[0].pixel);
  EXPECT_NEAR(problem.noise[1].pixel, 2.5 * noise[1].pixel, 0.3 * noise[1].pixel);
  EXPECT_NEAR(problem.noise[1].disparity, 2.5 * noise[1].disparity, 0.3 * noise[1].disparity);
}

TEST(BundleNoise, LevelWithFewLandmarksUsesTheScaleOfTheOther) {
  BundleProblem problem = test::simulateProblem({.landmarks = 200, .noise = 2.0}, 4);
  problem.landmarks.front().level = 1;
  const BundleResult result = test::adjustBundle(problem, BundleSettings{});
  EXPECT_EQ(result.noise_scale[1].pixel, result.noise_scale[0].pixel);
  EXPECT_EQ(result.noise_scale[1].disparity, result.noise_scale[0].disparity);
}

}  // namespace
}  // namespace cartvo::vo
