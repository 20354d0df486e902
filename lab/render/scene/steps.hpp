#pragma once

#include <vector>

namespace cartvo::world {

/// The values from, from + step, from + 2 step ... below `end`, by repeated addition, so that they equal
/// those of a floating-point loop counter. `step` > 0.
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
