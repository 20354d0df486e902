#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// The median, of an even number the upper one. Reorders the values, of which there must be some.
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

constexpr double kMedianOfNormal = 0.6745;  ///< of |e| for a standard normal e

/// Standard deviation of normal errors by the median of their sizes |e|, which outliers hardly move. Reorders
/// the sizes, of which there must be some.
inline double deviationOf(std::vector<double>& sizes) {
  return median(sizes) / kMedianOfNormal;
}

}  // namespace cartvo
