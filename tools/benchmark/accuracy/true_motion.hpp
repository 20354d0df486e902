#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tools/replay/replay.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::benchmark {

/// Assigns to each pair of a replay the index of its true pose.
class TruthRows {
 public:
  /// `truth` must have a pose at each left instant and be sorted by time.
  TruthRows(const Replay& replay, const Trajectory& truth);

  /// Index of the true pose at the instant of a pair; nothing if there is none.
  std::optional<std::size_t> at(std::size_t pair) const { return rows_[pair]; }

 private:
  std::vector<std::optional<std::size_t>> rows_;
};

/// Index of the pair from which the motion of the valid pair `index` > 0 was measured: the pair before, or an
/// earlier one after a gap.
std::size_t referenceOf(const Replay& replay, std::size_t index);

}  // namespace cartvo::benchmark
