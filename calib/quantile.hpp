#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// The value at place `share` (0 to 1) of the sorted values, the lower one where the place lies between two.
/// There must be some.
inline double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The median, of an even number the upper one. There must be some.
inline double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace cartvo
