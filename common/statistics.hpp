#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cartvo {

/// The value at rank `fraction` (0 to 1) of the sorted values; the lower one where the rank falls between
/// two. `values` must not be empty.
template <typename Value = double>
Value quantile(std::vector<Value> values, double fraction) {
  const auto rank =
      values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), rank, values.end());
  return *rank;
}

/// Median of `values`, which must not be empty; the upper one of an even number. Reorders them.
template <typename Value>
Value median(std::vector<Value>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// As median(), of a copy.
template <typename Value = double>
Value medianOf(std::vector<Value> values) {
  return median(values);
}

constexpr double kMedianOfNormal = 0.6745;  ///< median of |e| for a standard normal e

/// Robust standard deviation of normal errors: from the median of their magnitudes |e|, which outliers hardly
/// move. Reorders `magnitudes`, which must not be empty.
inline double stddevFromMedian(std::vector<double>& magnitudes) {
  return median(magnitudes) / kMedianOfNormal;
}

/// Nearest-rank percentile: the smallest value that at least `fraction` (0 to 1) of the values do not exceed.
/// NaN if there are none.
inline double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double last = static_cast<double>(values.size() - 1);
  const double rank = std::clamp(std::ceil(fraction * static_cast<double>(values.size())) - 1.0, 0.0, last);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace cartvo
