// Feature budget: reduction on a slow computer, and recovery.

#include "pipeline/feature_budget.hpp"

#include <gtest/gtest.h>

namespace cartvo::pipeline {
namespace {

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
