// Tests of the weights of image cells.
#include "vo_core/estimation/cell_noise.hpp"

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

constexpr double kPairs = 10.0, kOutlier = 2.0;

/// An adjusted problem with a grid of landmarks seen by its newest pair, one in each 20 px.
class CellNoiseTest : public testing::Test {
 protected:
  CellNoiseTest() {
    problem_.camera = {
        .focal_length = 400.0, .cx = 320.0, .cy = 200.0, .baseline = 0.1, .width = 640, .height = 400};
    problem_.poses.resize(2);
    for (double y = 10; y < 400; y += 20)
      for (double x = 10; x < 640; x += 20) {
        BundleLandmark& landmark = problem_.landmarks.emplace_back();
        landmark.observations.push_back({.pose = 0, .left = {x, y}});
        landmark.observations.push_back({.pose = 1, .left = {x, y}});
        landmark.error = 1.0;
      }
  }

  /// Sets the residuals of the landmarks in the left part of the image, in standard deviations.
  void setErrorsLeftOf(double x, double error) {
    for (BundleLandmark& landmark : problem_.landmarks)
      if (landmark.observations.back().left.x() < x) landmark.error = error;
  }

  void update(int pairs) {
    for (int i = 0; i < pairs; ++i)
      noise_.update(problem_);
  }

  double weightAt(double x, double y) const { return noise_.weightAt(problem_.camera, {x, y}); }

  double meanWeight() const {
    double sum = 0.0;
    for (const BundleLandmark& landmark : problem_.landmarks)
      sum += noise_.weightAt(problem_.camera, landmark.observations.back().left);
    return sum / static_cast<double>(problem_.landmarks.size());
  }

  BundleProblem problem_;
  CellNoise noise_{kPairs, kOutlier};
};

TEST_F(CellNoiseTest, WeighsAllCellsAlikeAtFirstAndWithEqualResiduals) {
  EXPECT_EQ(weightAt(100, 100), 1.0);
  setErrorsLeftOf(640, 1.7);
  update(30);
  for (const BundleLandmark& landmark : problem_.landmarks)
    EXPECT_NEAR(noise_.weightAt(problem_.camera, landmark.observations.back().left), 1.0, 1e-12);
}

TEST_F(CellNoiseTest, WeighsByTheInverseVarianceAndKeepsTheInformation) {
  setErrorsLeftOf(320, 1.8);
  update(100);
  EXPECT_NEAR(weightAt(500, 200) / weightAt(100, 200), 1.8 * 1.8, 0.5) << "a prior of one landmark in four";
  EXPECT_NEAR(meanWeight(), 1.0, 1e-9);
}

TEST_F(CellNoiseTest, CountsOutliersUpToTheirLimit) {
  setErrorsLeftOf(320, kOutlier);
  update(20);
  const double at_limit = weightAt(100, 200);
  setErrorsLeftOf(320, 1000.0);
  update(20);
  EXPECT_NEAR(weightAt(100, 200), at_limit, 0.05 * at_limit);
}

TEST_F(CellNoiseTest, ForgetsWithinTheMemory) {
  setErrorsLeftOf(320, 2.0);
  update(50);
  EXPECT_LT(weightAt(100, 200), 0.5 * weightAt(500, 200));
  setErrorsLeftOf(320, 1.0);
  update(50);
  EXPECT_NEAR(weightAt(100, 200), 1.0, 0.02);
}

TEST_F(CellNoiseTest, IgnoresLandmarksThatTheNewestPairDidNotSee) {
  for (BundleLandmark& landmark : problem_.landmarks)
    if (landmark.observations.back().left.x() < 320) {
      landmark.error = 2.0;
      landmark.observations.back().pose = 0;
    }
  update(50);
  EXPECT_NEAR(weightAt(100, 200), weightAt(500, 200), 1e-9);
}

TEST_F(CellNoiseTest, StaysAsItIsWithoutLandmarks) {
  problem_.landmarks.clear();
  update(3);
  EXPECT_EQ(weightAt(100, 200), 1.0);
}

}  // namespace
}  // namespace cartvo::vo
