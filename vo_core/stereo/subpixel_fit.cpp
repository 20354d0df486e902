// Sinusoidal sub-pixel fit of correlation peaks.
#include "vo_core/stereo/subpixel_fit.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {

namespace {

/// Whether a sinusoid fits; `cosine` is that of its phase step between samples.
bool fits(double middle, double cosine) {
  return middle > 0.0 && cosine < 1.0 && cosine > -1.0;
}

}  // namespace

double sinusoidalHeight(double left, double middle, double right) {
  const double cosine = (left + right) / (2.0 * middle);
  if (!fits(middle, cosine)) return middle;
  // middle / cos p = middle sqrt(1 + tan^2 p)
  const double slope = (left - right) / (2.0 * middle);
  return middle * std::sqrt(1.0 + slope * slope / (1.0 - cosine * cosine));
}

double sinusoidalOffset(double left, double middle, double right) {
  const double cosine = (left + right) / (2.0 * middle);
  if (!fits(middle, cosine)) return 0.0;
  const double frequency = std::acos(cosine);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const double phase = std::atan((left - right) / (2.0 * middle * sine));
  return std::clamp(-phase / frequency, -0.5, 0.5);
}

}  // namespace cartvo::vo
