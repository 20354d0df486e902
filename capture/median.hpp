#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// The median, of an even number the upper one. There must be some. Not for use outside capture, which knows
/// no other part of cartvo: calib and vo_core have theirs.
inline double medianOfDelays(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace cartvo
