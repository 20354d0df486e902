#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// The median; of an even number of values the upper one. Requires at least one value. For use in capture
/// only: capture depends on no other part of cartvo.
inline double upperMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace cartvo
