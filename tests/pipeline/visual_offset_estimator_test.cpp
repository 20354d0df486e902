// Closed loop of the visual offset estimate and the timestamps, with an odometry that averages over 10 s.
#include "pipeline/visual_offset_estimator.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/feature_budget.hpp"

namespace cartvo::pipeline {
namespace {

constexpr double kStep = 1.0 / 18.0;  // s

/// Simulates timestamps and an odometry that estimates their offset as a mean over 10 s, 10 % too small.
class Loop {
 public:
  explicit Loop(double truth_ns) : truth_ns_(truth_ns) {}

  void drive(double seconds, double stddev) {
    for (double t = 0.0; t < seconds; t += kStep) {
      weight_ = weight_ * std::exp(-kStep / 10.0) + 1.0;
      residual_ns_ += (truth_ns_ - applied_correction_ns_ - residual_ns_) / weight_;
      vo::RigCalibrationError rig;
      rig.delay = {0.9e-9 * residual_ns_, stddev};
      estimate_ = estimator_.update(rig, applied_correction_ns_, kStep);
      if (!estimate_) continue;
      const double max_slew = 5e6 * kStep;  // StereoTimestamper slews by 0.5 %
      applied_correction_ns_ += std::clamp(estimate_->value_ns - applied_correction_ns_, -max_slew, max_slew);
    }
  }
  double error() const { return applied_correction_ns_ - truth_ns_; }
  const std::optional<capture::OffsetEstimate>& estimate() const { return estimate_; }

 private:
  double truth_ns_;
  double applied_correction_ns_ = 0.0;
  double residual_ns_ = 0.0;
  double weight_ = 0.0;
  VisualOffsetEstimator estimator_;
  std::optional<capture::OffsetEstimate> estimate_;
};

TEST(VisualOffsetEstimator, ConvergesToTwoMillisecondsWithinTwentySeconds) {
  for (const double truth_ns : {-25e6, -10e6, 0.0, 3e6, 25e6}) {
    Loop loop(truth_ns);
    loop.drive(20.0, 3e-4);
    EXPECT_NEAR(loop.error(), 0.0, 2e6) << truth_ns;
    EXPECT_LE(std::abs(loop.error()), 2.0 * loop.estimate()->stddev_ns) << truth_ns;
    loop.drive(40.0, 3e-4);
    EXPECT_NEAR(loop.error(), 0.0, 0.2e6) << truth_ns;
  }
}

TEST(VisualOffsetEstimator, ReturnsNothingWithoutAccurateOdometryEstimate) {
  Loop loop(5e6);
  loop.drive(20.0, 8e-3);
  EXPECT_FALSE(loop.estimate());
  VisualOffsetEstimator estimator;
  EXPECT_FALSE(estimator.update(std::nullopt, 0.0, kStep));
}

TEST(VisualOffsetEstimator, KeepsEstimateWithGrowingStddevDuringStandstill) {
  Loop loop(5e6);
  loop.drive(30.0, 3e-4);
  const capture::OffsetEstimate before = *loop.estimate();
  loop.drive(60.0, 8e-3);
  EXPECT_NEAR(loop.estimate()->value_ns, before.value_ns, 0.1e6);
  EXPECT_GT(loop.estimate()->stddev_ns, before.stddev_ns + 0.3e6);
}

constexpr double kPeriod = 0.04;

/// A computer whose time for a pair grows with the features.
double secondsFor(int features, double slowness) {
  return slowness * (0.005 + 2e-5 * features);
}

int settle(FeatureBudget& budget, int features, double slowness, int pairs = 200) {
  for (int pair = 0; pair < pairs; ++pair)
    features = budget.update(secondsFor(features, slowness), kPeriod);
  return features;
}

TEST(FeatureBudget, KeepsAllFeaturesOnFastComputer) {
  FeatureBudget budget(1000);
  for (int pair = 0; pair < 100; ++pair)
    ASSERT_EQ(budget.update(secondsFor(1000, 1.0), kPeriod), 1000);
}

TEST(FeatureBudget, ReducesFeaturesToFitThePeriodOnSlowComputer) {
  FeatureBudget budget(1000);
  const int features = settle(budget, 1000, 3.0);
  EXPECT_LT(secondsFor(features, 3.0), kPeriod);
  EXPECT_GT(secondsFor(features, 3.0), 0.5 * kPeriod) << "no larger reduction than necessary";
}

TEST(FeatureBudget, FitsThePeriodAfterSixPairs) {
  FeatureBudget budget(1000);
  const int features = settle(budget, 1000, 4.0, 6);
  EXPECT_LT(secondsFor(features, 4.0), kPeriod);
}

TEST(FeatureBudget, IgnoresASingleSlowPair) {
  FeatureBudget budget(1000);
  budget.update(secondsFor(1000, 1.0), kPeriod);
  EXPECT_EQ(budget.update(1.0, kPeriod), 1000);
  EXPECT_EQ(budget.update(secondsFor(1000, 1.0), kPeriod), 1000);
}

TEST(FeatureBudget, RestoresFeaturesGradually) {
  FeatureBudget budget(1000);
  int features = settle(budget, 1000, 4.0);
  ASSERT_LT(features, 500);
  for (int pair = 0; pair < 300; ++pair) {
    const int next = budget.update(secondsFor(features, 1.0), kPeriod);
    EXPECT_GE(next, features);
    EXPECT_LE(next, features * 1.03 + 1.0);
    features = next;
  }
  EXPECT_EQ(features, 1000);
}

TEST(FeatureBudget, KeepsMinimumNumberOfFeatures) {
  FeatureBudget budget(1000);
  EXPECT_EQ(settle(budget, 1000, 1000.0), 150);
  FeatureBudget modest(60);
  EXPECT_EQ(settle(modest, 60, 1000.0), 60);
}

}  // namespace

}  // namespace cartvo::pipeline
