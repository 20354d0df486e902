// Assigns true poses to the pairs of a replay.
#include "tools/benchmark/accuracy/true_motion.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::benchmark {

TruthRows::TruthRows(const Replay& replay, const Trajectory& truth) {
  for (const ReplayedPair& pair : replay.pairs) {
    const auto row = std::lower_bound(
        truth.begin(), truth.end(), pair.exposure_ns,
        [](const StampedPose& stamped, std::int64_t instant_ns) { return stamped.time_ns < instant_ns; });
    const bool is_known = row != truth.end() && row->time_ns == pair.exposure_ns;
    rows_.push_back(is_known ? std::optional<std::size_t>(row - truth.begin()) : std::nullopt);
  }
}

std::size_t referenceOf(const Replay& replay, std::size_t index) {
  const ReplayedPair& pair = replay.pairs[index];
  const auto distance = [&](std::size_t from) {
    const double step = 1e-9 * static_cast<double>(pair.exposure_ns - replay.pairs[from].exposure_ns);
    return std::abs(step - pair.time_step);
  };
  std::size_t reference = index - 1;
  while (reference > 0 && distance(reference - 1) < distance(reference))
    --reference;
  return reference;
}

}  // namespace cartvo::benchmark
