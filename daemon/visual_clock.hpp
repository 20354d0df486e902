#pragma once

#include <optional>

#include "capture/pair_clock.hpp"
#include "vo_core/rig_check.hpp"

namespace cartvo {

/// How much later the right camera is exposed than undelayed arrival says, by the pictures: what the odometry
/// finds the stamps to be off by, beyond what has been put into them already. In the rows of the right image
/// a delay shows wherever the cart moves: forward motion and bumps do, not only turns. One thread.
class VisualClock {
 public:
  /// A pair was processed, `time_step` s after the one before. `rig`: what it tells; nothing while unknown.
  /// `applied_ns`: by how much its offset was more than undelayed arrival says. Returns what is known;
  /// while the cart stands, that is what was known last, a little less certain each second.
  std::optional<ClockWitness> add(const std::optional<RigCheck>& rig, double applied_ns, double time_step);

 private:
  double applied_ns_ = 0.0;  ///< mean over the memory that the odometry's delay has
  double weight_ = 0.0;      ///< s, in that mean
  std::optional<ClockWitness> known_;
};

}  // namespace cartvo
