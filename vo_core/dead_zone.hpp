#pragma once

#include <algorithm>
#include <cmath>

namespace cartvo {

/// Nothing in the dead zone, nearly all of what is far beyond it, no jump between, at most so much: the
/// non-negative garrote (H. Gao, "Wavelet shrinkage denoising using the non-negative garrote", 1998).
inline double beyondDeadZone(double value, double dead, double most) {
  const double size = std::abs(value);
  if (size <= dead) return 0.0;
  return std::copysign(std::min(size - dead * dead / size, most), value);
}

}  // namespace cartvo
