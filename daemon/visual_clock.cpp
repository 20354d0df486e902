// The loop from the odometry's findings back to the stamps.

#include "daemon/visual_clock.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

constexpr double kMemory = 10.0;        // s: RowMonitor's, so that both are means over the same pairs
constexpr double kUseful_ns = 3e6;      // a deviation beyond it tells less than arrival
constexpr double kForgetting_ns = 1e4;  // each second without news
// A delay of 25 ms is found 10 % short, one of 45 ms by half (docs/capture.md); as what was found is put into
// the stamps, less is left.
constexpr double kShort = 0.1;
constexpr double kLinear_ns = 12e6;

}  // namespace

std::optional<ClockWitness> VisualClock::add(const std::optional<RigCheck>& rig, double applied_ns,
                                             double time_step) {
  const double elapsed = std::max(time_step, 1e-3);
  weight_ = weight_ * std::exp(-elapsed / kMemory) + elapsed;
  applied_ns_ += elapsed / weight_ * (applied_ns - applied_ns_);
  if (known_) known_->deviation_ns += kForgetting_ns * elapsed;
  if (!rig) return known_;
  const double delay_ns = 1e9 * rig->delay.value;
  const double found_ns = 1e9 * rig->delay.deviation;
  const double short_ns = kShort * std::abs(delay_ns) * std::max(1.0, std::abs(delay_ns) / kLinear_ns);
  const double deviation_ns = std::hypot(found_ns, short_ns);
  const bool better = known_ && deviation_ns < known_->deviation_ns;
  if (found_ns < kUseful_ns || better) known_ = ClockWitness{applied_ns_ + delay_ns, deviation_ns};
  return known_;
}

}  // namespace cartvo
