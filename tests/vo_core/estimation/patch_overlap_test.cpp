// Compares the mean patch overlap with a sum over all pairs of patches.
#include "vo_core/estimation/patch_overlap.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/image_pyramid.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 300, kHeight = 200;

BundleProblem problemOfTwoPoses() {
  BundleProblem problem;
  problem.camera = {200.0, 150.0, 100.0, 0.1, kWidth, kHeight};
  problem.poses.resize(2);
  return problem;
}

void addLandmark(BundleProblem& problem, const Eigen::Vector2d& pixel, int level = 0, double weight = 1.0) {
  BundleLandmark& landmark = problem.landmarks.emplace_back();
  landmark.level = level;
  landmark.weight = weight;
  for (int pose = 0; pose < 2; ++pose)
    landmark.observations.push_back({pose, false, pixel, pixel});
}

double overlapByPairs(const BundleProblem& problem) {
  double sum = 0.0, information = 0.0;
  for (const BundleLandmark& one : problem.landmarks) {
    const double side = kPatchSide * levelScale(one.level);
    const double weight = one.weight / std::pow(problem.noise[one.level].pixel, 2);
    information += weight;
    for (const BundleLandmark& other : problem.landmarks) {
      if (other.level != one.level) continue;
      const Eigen::Vector2d apart =
          (one.observations.back().left - other.observations.back().left).cwiseAbs();
      sum += weight * std::max(1.0 - apart.x() / side, 0.0) * std::max(1.0 - apart.y() / side, 0.0);
    }
  }
  return sum / information;
}

TEST(PatchOverlap, IsOneWithoutOverlapAndTheCountForIdenticalPatches) {
  BundleProblem problem = problemOfTwoPoses();
  PatchOverlap overlap;
  EXPECT_EQ(overlap.compute(problem), 1.0);  // no landmarks
  for (int i = 0; i < 5; ++i)
    addLandmark(problem, {20.0 + 40.0 * i, 50.0});
  EXPECT_NEAR(overlap.compute(problem), 1.0, 1e-12);
  problem.landmarks.clear();
  for (int i = 0; i < 5; ++i)
    addLandmark(problem, {20.0, 50.0});
  EXPECT_NEAR(overlap.compute(problem), 5.0, 1e-12);
}

TEST(PatchOverlap, AgreesWithTheSumOverAllPairs) {
  test::Noise noise(2);
  PatchOverlap overlap;
  for (const int count : {3, 40, 240}) {
    BundleProblem problem = problemOfTwoPoses();
    problem.noise[1].pixel = 0.3;
    for (int i = 0; i < count; ++i)  // some at the image edge and slightly beyond
      addLandmark(problem, {(kWidth + 2.0) * noise.uniform() - 1.0, (kHeight + 2.0) * noise.uniform() - 1.0},
                  i % 3 == 0 ? 1 : 0, noise.uniform());
    EXPECT_NEAR(overlap.compute(problem), overlapByPairs(problem), 1e-9 * count);
  }
}

TEST(PatchOverlap, IsApproximatedBySamplingForManyPatches) {
  test::Noise noise(3);
  BundleProblem problem = problemOfTwoPoses();
  for (int i = 0; i < 4000; ++i)
    addLandmark(problem, {kWidth * noise.uniform(), kHeight * noise.uniform()});
  const double all = overlapByPairs(problem);
  EXPECT_NEAR(PatchOverlap().compute(problem), all, 0.03 * all);
}

TEST(PatchOverlap, CountsOnlyLandmarksOfTheNewestPair) {
  BundleProblem problem = problemOfTwoPoses();
  addLandmark(problem, {50.0, 50.0});
  addLandmark(problem, {50.0, 50.0});
  problem.landmarks.back().observations.back().pose = 0;
  EXPECT_NEAR(PatchOverlap().compute(problem), 1.0, 1e-12);
}

}  // namespace
}  // namespace cartvo::vo
