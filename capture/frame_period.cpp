#include "capture/frame_period.hpp"

#include <algorithm>
#include <vector>

namespace cartvo {
namespace {

constexpr std::size_t kIntervalsNeeded = 4;
constexpr std::size_t kIntervalsKept = 64;

}  // namespace

void FramePeriod::add(std::int64_t instant_ns) {
  const std::optional<std::int64_t> before = last_ns_;
  if (before && instant_ns <= *before) return;
  last_ns_ = instant_ns;
  if (!before) return;
  intervals_.push_back(instant_ns - *before);
  if (intervals_.size() > kIntervalsKept) intervals_.pop_front();
  if (intervals_.size() < kIntervalsNeeded) return;

  std::vector<std::int64_t> sorted(intervals_.begin(), intervals_.end());
  const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quartile, sorted.end());
  period_ns_ = *quartile;
}

}  // namespace cartvo
