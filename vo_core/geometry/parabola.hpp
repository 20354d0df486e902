#pragma once

#include <algorithm>

namespace cartvo::vo {

/// Place of the vertex of a parabola through three equidistant values, relative to the middle one, which is
/// the highest; within half a step.
inline double vertexOfParabola(double before, double middle, double after) {
  const double curvature = before - 2.0 * middle + after;
  return curvature < 0.0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0.0;
}

}  // namespace cartvo::vo
