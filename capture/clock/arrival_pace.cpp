// Comparison of RTP time with the arrivals of its pictures.

#include "capture/clock/arrival_pace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/statistics.hpp"

namespace cartvo::capture {
namespace {

// Settling. Two halves of 0.2 s whose fastest pictures differ by less than the tolerance: 5 % of the pace.
constexpr std::int64_t kSettlingTime_ns = 400'000'000;
constexpr std::size_t kSettlingPictures = 6;
constexpr std::int64_t kTolerance_ns = 10'000'000;  // the default limit of the offset's uncertainty
// A path that was congested from the beginning becomes free within this time, or is the usual one.
constexpr std::int64_t kYoung_ns = 6'000'000'000;

// Pace.
constexpr std::int64_t kBlock_ns = 500'000'000;
constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlocksToFindFast = 6;
// Pictures that arrive ever later may also be those of a network that fills up.
constexpr std::size_t kBlocksToFindSlow = kBlocks;
constexpr double kMaxDeviation = 0.005;  // crystals: 1e-4
constexpr double kEnd = 0.003;           // of a deviation that was found

}  // namespace

void ArrivalPace::add(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  const Point point{arrival_ns, arrival_ns - rtp_ns};
  if (!first_arrival_ns_) first_arrival_ns_ = arrival_ns;
  const bool is_young = arrival_ns - *first_arrival_ns_ < kYoung_ns;
  if (settled_ && is_young && point.delay_ns < least_delay_ns_ - kTolerance_ns) {
    settled_ = false;  // earlier pictures were late
    window_.clear();
  }
  if (!settled_) settle(point);
  least_delay_ns_ = std::min(least_delay_ns_, point.delay_ns);
  comparePace(point);
}

void ArrivalPace::settle(const Point& point) {
  window_.push_back(point);
  if (window_.size() < kSettlingPictures || point.arrival_ns - window_.front().arrival_ns < kSettlingTime_ns)
    return;
  const auto middle = window_.begin() + static_cast<std::ptrdiff_t>(window_.size() / 2);
  const auto earlier = [](const Point& a, const Point& b) { return a.delay_ns < b.delay_ns; };
  const std::int64_t first = std::min_element(window_.begin(), middle, earlier)->delay_ns;
  const std::int64_t second = std::min_element(middle, window_.end(), earlier)->delay_ns;
  settled_ = std::abs(second - first) <= kTolerance_ns;
  if (settled_) {
    least_delay_ns_ = std::min(first, second);
    window_.clear();
  } else {
    window_.erase(window_.begin(), middle);
  }
}

/// Median of the pace between consecutive blocks: a single change of the delay does not count.
void ArrivalPace::comparePace(const Point& point) {
  if (blocks_.empty() || point.arrival_ns - block_begin_ns_ >= kBlock_ns) {
    blocks_.push_back(point);
    block_begin_ns_ = point.arrival_ns;
    // A deviation that was found ends with the latest blocks.
    while (blocks_.size() > (deviation_ ? kBlocksToFindFast + 1 : kBlocks))
      blocks_.pop_front();
  } else if (point.delay_ns < blocks_.back().delay_ns) {
    blocks_.back() = point;
    return;
  }
  if (blocks_.size() < kBlocksToFindFast) return;
  std::vector<double> deviations;
  for (std::size_t i = 1; i + 1 < blocks_.size(); ++i) {  // the last block is not complete
    const double elapsed = static_cast<double>(blocks_[i].arrival_ns - blocks_[i - 1].arrival_ns);
    if (elapsed > 0.0)
      deviations.push_back(static_cast<double>(blocks_[i - 1].delay_ns - blocks_[i].delay_ns) / elapsed);
  }
  if (deviations.empty()) return;
  const double median = medianOf(std::move(deviations));
  const bool is_wrong = median > kMaxDeviation ||
                        (median < -kMaxDeviation && (deviation_ || blocks_.size() >= kBlocksToFindSlow));
  if (is_wrong || (deviation_ && std::abs(median) > kEnd)) {
    deviation_ = median;
  } else {
    deviation_.reset();
  }
}

}  // namespace cartvo::capture
