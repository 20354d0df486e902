// Arc tangent and tangent with bit-identical results on every machine.
#include "calib/model/arc_tangent.hpp"

#include <cmath>

namespace cartvo::calib {

double portableArcTangent(double x) {
  // atan x = 2 atan(x / (1 + sqrt(1 + x^2))): four halvings reduce pi/2 to pi/32, where the first omitted
  // term of the series is 5e-19.
  constexpr int kHalvings = 4;
  for (int halving = 0; halving < kHalvings; ++halving)
    x /= 1.0 + std::sqrt(1.0 + x * x);
  const double x2 = x * x;
  double series = 0.0;
  for (int power = 15; power >= 1; power -= 2)
    series = 1.0 / power - x2 * series;
  return (1 << kHalvings) * x * series;
}

double portableTangent(double angle) {
  // The arc tangent is concave: Newton's method from below never overshoots, so it converges.
  constexpr int kMaxSteps = 60;
  double tangent = angle;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double correction = (angle - portableArcTangent(tangent)) * (1.0 + tangent * tangent);
    tangent += correction;
    if (std::abs(correction) <= 1e-15 * tangent) break;
  }
  return tangent;
}

}  // namespace cartvo::calib
