// Feature budget: adapts the number of features to the computer's load.
#include "pipeline/feature_budget.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::pipeline {
namespace {

constexpr double kMaxLoad = 0.8;             // periods; above it the number of features is reduced
constexpr double kTargetLoad = 0.7;          // periods; load after a reduction; below it features are added
constexpr double kMinReductionFactor = 0.5;  // per pair
constexpr double kRecoveryFactor = 1.02;     // per pair: doubles the number in 35 pairs
constexpr int kMinFeatures = 150;            // fewer would cost more accuracy than the delay costs

}  // namespace

FeatureBudget::FeatureBudget(int max_features) : max_features_(max_features), features_(max_features) {}

int FeatureBudget::update(double processing_time, double period) {
  const double load = processing_time / period;
  // The smaller load of two pairs: a single pair may take longer because of another process.
  const double sustained = std::min(load, last_load_);
  last_load_ = load;
  if (sustained > kMaxLoad)
    features_ *= std::max(kTargetLoad / sustained, kMinReductionFactor);
  else if (load < kTargetLoad)
    features_ *= kRecoveryFactor;
  features_ = std::clamp<double>(features_, std::min(kMinFeatures, max_features_), max_features_);
  return static_cast<int>(std::lround(features_));
}

}  // namespace cartvo::pipeline
