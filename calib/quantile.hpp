#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// The quantile `share` (0 to 1) of the values: the lower one where it falls between two. Requires at least
/// one value.
inline double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The median: the upper one of an even number of values. Requires at least one value.
inline double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace cartvo
