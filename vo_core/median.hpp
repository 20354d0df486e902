#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// Median of `values`, which must not be empty; the upper one of an even number. Reorders them.
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

constexpr double kMedianOfNormal = 0.6745;  ///< median of |e| for a standard normal e

/// Robust standard deviation of normal errors: from the median of their magnitudes |e|, which outliers hardly
/// move. Reorders `sizes`, which must not be empty.
inline double stddevFromMedian(std::vector<double>& sizes) {
  return median(sizes) / kMedianOfNormal;
}

}  // namespace cartvo
