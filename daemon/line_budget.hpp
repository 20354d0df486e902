#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace cartvo {

/// How many lines something that repeats may put into the log: a few at once, then one in ten seconds. One
/// thread.
class LineBudget {
 public:
  using Clock = std::chrono::steady_clock;

  /// Whether a line may be logged now; `now` never goes back.
  bool allows(Clock::time_point now) {
    if (!last_refill_) last_refill_ = now;
    const auto periods = (now - *last_refill_) / kPeriod;
    lines_ = static_cast<int>(std::min<std::int64_t>(lines_ + periods, kMostAtOnce));
    *last_refill_ += periods * kPeriod;
    return lines_ > 0;
  }

  /// A line was logged.
  void spend() { --lines_; }

 private:
  static constexpr int kMostAtOnce = 5;
  static constexpr std::chrono::seconds kPeriod{10};

  int lines_ = kMostAtOnce;
  std::optional<Clock::time_point> last_refill_;
};

}  // namespace cartvo
