// The sub-pixel step of the stereo match.
#include "vo_core/subpixel_fit.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {

Peak sinusoidalPeak(double left, double middle, double right) {
  const double cosine = (left + right) / (2.0 * middle);
  if (!(middle > 0.0) || !(cosine < 1.0) || !(cosine > -1.0)) return {0.0, middle};
  const double frequency = std::acos(cosine);
  const double phase = std::atan((left - right) / (2.0 * middle * std::sin(frequency)));
  return {std::clamp(-phase / frequency, -0.5, 0.5), middle / std::cos(phase)};
}

}  // namespace cartvo
