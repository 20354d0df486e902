#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace cartvo {

/// Learns the time between two frames of a camera from the instants of those that arrived.
class FramePeriod {
 public:
  /// The instant of the next frame, ns. Instants that do not increase are ignored.
  void add(std::int64_t instant_ns);

  /// The instants that follow do not continue those before; what was learned stays.
  void restart() { last_ns_.reset(); }

  /// ns; 0 until enough intervals were seen. The lower quartile of the latest intervals: right while less
  /// than three quarters of them span lost frames, and never much too long.
  std::int64_t periodNs() const { return period_ns_; }

 private:
  std::deque<std::int64_t> intervals_;
  std::optional<std::int64_t> last_ns_;
  std::int64_t period_ns_ = 0;
};

}  // namespace cartvo
