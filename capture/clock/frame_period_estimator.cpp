// Frame period as the lower quartile of the latest intervals.

#include "capture/clock/frame_period_estimator.hpp"

#include <algorithm>
#include <vector>

namespace cartvo::capture {
namespace {

constexpr std::size_t kMinIntervals = 4;
constexpr std::size_t kMaxIntervals = 16;  // a camera that halves its rate at dusk is followed in a second

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
  period_ns_ = *quartile;
}

}  // namespace cartvo::capture
