#pragma once

#include <vector>

namespace cartvo::world {

/// from, from + step, from + 2 step ... as long as they are below `end`; summed up, so that the values are
/// those of a counter in floating point. `step` > 0.
inline std::vector<double> stepsBelow(double end, double from, double step) {
  std::vector<double> values;
  double value = from;
  while (value < end) {
    values.push_back(value);
    value += step;
  }
  return values;
}

}  // namespace cartvo::world
