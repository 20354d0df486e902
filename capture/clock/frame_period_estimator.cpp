// Frame period as the mean of the latest intervals that span no lost frame.

#include "capture/clock/frame_period_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cartvo::capture {
namespace {

constexpr std::size_t kMinIntervals = 4;
constexpr std::size_t kMaxIntervals = 16;  // a camera that halves its rate at dusk is followed in a second
constexpr double kLostFrame = 1.5;         // lower quartiles; longer intervals span lost frames

}  // namespace

void FramePeriodEstimator::add(std::int64_t instant_ns) {
  const std::optional<std::int64_t> previous = last_ns_;
  if (previous && instant_ns <= *previous) return;
  last_ns_ = instant_ns;
  if (!previous) return;
  intervals_.push_back(instant_ns - *previous);
  if (intervals_.size() > kMaxIntervals) intervals_.pop_front();
  if (intervals_.size() < kMinIntervals) return;

  std::vector<std::int64_t> sorted(intervals_.begin(), intervals_.end());
  const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quartile, sorted.end());
  const double longest = kLostFrame * static_cast<double>(*quartile);
  double sum = 0.0;
  double count = 0.0;
  for (const std::int64_t interval : intervals_) {
    if (static_cast<double>(interval) > longest) continue;
    sum += static_cast<double>(interval);
    count += 1.0;
  }
  period_ns_ = std::llround(sum / count);
}

}  // namespace cartvo::capture
