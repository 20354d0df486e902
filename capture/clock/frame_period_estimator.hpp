#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace cartvo::capture {

/// Estimates a camera's frame period from the instants of its frames.
class FramePeriodEstimator {
 public:
  /// Adds the instant of the next frame, ns. Instants that do not increase are ignored.
  void add(std::int64_t instant_ns);

  /// Discards the last instant, because those that follow do not continue it; keeps the intervals.
  void restart() { last_ns_.reset(); }

  /// Frame period, ns; 0 until enough intervals were added. The mean of the latest intervals up to one and a
  /// half times their lower quartile: correct while less than three quarters of them span lost frames, also
  /// where instants are rounded or some of them are late.
  std::int64_t periodNs() const { return period_ns_; }

 private:
  std::deque<std::int64_t> intervals_;
  std::optional<std::int64_t> last_ns_;
  std::int64_t period_ns_ = 0;
};

}  // namespace cartvo::capture
