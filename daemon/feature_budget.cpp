// Fewer features rather than late ones.
#include "daemon/feature_budget.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

constexpr double kMostLoad = 0.8;   // of a period; what is above is shed
constexpr double kAimedLoad = 0.7;  // that shedding aims at; below, features come back
constexpr double kMostAtOnce = 0.5;
constexpr double kComingBack = 1.02;  // each pair: twice as many in 35 pairs
constexpr int kFewest = 150;          // below, accuracy suffers more than delay would harm

}  // namespace

FeatureBudget::FeatureBudget(int most, double period) : most_(most), period_(period), features_(most) {}

int FeatureBudget::next(double seconds) {
  const double load = seconds / period_;
  // Of two pairs the quicker one: once in a while one takes longer for somebody else's sake.
  const double sustained = std::min(load, last_load_);
  last_load_ = load;
  if (sustained > kMostLoad)
    features_ *= std::max(kAimedLoad / sustained, kMostAtOnce);
  else if (load < kAimedLoad)
    features_ *= kComingBack;
  features_ = std::clamp<double>(features_, std::min(kFewest, most_), most_);
  return static_cast<int>(std::lround(features_));
}

}  // namespace cartvo
