#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace cartvo::world {

/// A uniform cubic B-spline over time: twice continuously differentiable; it approximates its control values.
/// Constant before the first and after the last value.
class UniformSpline {
 public:
  UniformSpline() = default;
  /// `values`: control values at times 0, `step`, 2 `step` ...
  UniformSpline(double step, std::vector<double> values) : step_(step), values_(std::move(values)) {
    integrals_.resize(values_.size() + 1, 0.0);
    for (int k = 0; k < static_cast<int>(values_.size()); ++k) {
      integrals_[k + 1] = integrals_[k] + step_ * segmentIntegral(k, 1.0);
    }
  }

  double value(double time) const {
    const auto [k, x] = locate(time);
    const double y = 1.0 - x;
    return (y * y * y * control(k - 1) + (3.0 * x * x * x - 6.0 * x * x + 4.0) * control(k) +
            (3.0 * y * y * y - 6.0 * y * y + 4.0) * control(k + 1) + x * x * x * control(k + 2)) /
           6.0;
  }

  /// Exact integral from time 0 to `time`; negative times and those after the last value, too.
  double integral(double time) const {
    const auto [k, x] = locate(time);
    const double beyond =
        time < 0.0 ? time : std::max(time - step_ * static_cast<double>(values_.size()), 0.0);
    return integrals_[k] + step_ * segmentIntegral(k, x) + beyond * value(time);
  }

 private:
  std::pair<int, double> locate(double time) const {
    const double position = std::clamp(time / step_, 0.0, static_cast<double>(values_.size()) - 1e-9);
    const double whole = std::floor(position);
    return {static_cast<int>(whole), position - whole};
  }
  double control(int k) const { return values_[std::clamp(k, 0, static_cast<int>(values_.size()) - 1)]; }
  double segmentIntegral(int k, double x) const {
    const double y = 1.0 - x;
    const double x3 = x * x * x;
    const double y3 = y * y * y;
    return ((1.0 - y3 * y) / 4.0 * control(k - 1) + (0.75 * x3 * x - 2.0 * x3 + 4.0 * x) * control(k) +
            (0.75 * (1.0 - y3 * y) - 2.0 * (1.0 - y3) + 4.0 * x) * control(k + 1) +
            0.25 * x3 * x * control(k + 2)) /
           6.0;
  }

  double step_ = 1.0;
  std::vector<double> values_{0.0};
  std::vector<double> integrals_{0.0, 0.0};
};

}  // namespace cartvo::world
