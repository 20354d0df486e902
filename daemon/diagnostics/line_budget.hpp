#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace cartvo::daemon {

/// Rate limit for repeated log lines: five at once, then one in ten seconds. Not thread-safe.
class LineBudget {
 public:
  using Clock = std::chrono::steady_clock;

  /// True if a line may be logged now; `now` must not decrease.
  bool allows(Clock::time_point now) {
    if (!last_refill_) last_refill_ = now;
    const auto periods = (now - *last_refill_) / kRefillPeriod;
    lines_ = static_cast<int>(std::min<std::int64_t>(lines_ + periods, kMaxLines));
    *last_refill_ += periods * kRefillPeriod;
    return lines_ > 0;
  }

  /// Counts a logged line.
  void spend() { --lines_; }

 private:
  static constexpr int kMaxLines = 5;
  static constexpr std::chrono::seconds kRefillPeriod{10};

  int lines_ = kMaxLines;
  std::optional<Clock::time_point> last_refill_;
};

}  // namespace cartvo::daemon
