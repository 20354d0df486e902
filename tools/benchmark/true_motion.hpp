#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tools/replay/replay.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::benchmark {

/// Where a replay's pairs stand in a truth that has a pose at each left instant.
class TrueRows {
 public:
  /// `truth` must be in the order of time.
  TrueRows(const Replay& replay, const Trajectory& truth);

  /// The truth's row at a pair's instant, if it has one.
  std::optional<std::size_t> at(std::size_t pair) const { return rows_[pair]; }

 private:
  std::vector<std::optional<std::size_t>> rows_;
};

/// The pair that the motion of valid pair `index` > 0 was measured from: the one before, or an earlier one
/// across a gap.
std::size_t referenceOf(const Replay& replay, std::size_t index);

}  // namespace cartvo::benchmark
