#pragma once

#include <algorithm>
#include <cmath>

namespace cartvo::vo {

/// Applies a dead zone to `value`, by the non-negative garrote (H. Gao, "Wavelet shrinkage denoising using
/// the non-negative garrote", 1998), and a limit. Zero for |value| <= dead_zone, continuous, close to the
/// value far beyond; the magnitude is at most `limit`.
inline double applyDeadZone(double value, double dead_zone, double limit) {
  const double size = std::abs(value);
  if (size <= dead_zone) return 0.0;
  return std::copysign(std::min(size - dead_zone * dead_zone / size, limit), value);
}

}  // namespace cartvo::vo
