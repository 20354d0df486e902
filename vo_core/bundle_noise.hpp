#pragma once

#include <algorithm>

#include "vo_core/bundle_adjustment.hpp"

namespace cartvo {

/// The noise to be assumed from now on, by what the residuals of an adjusted pair tell: a running estimate,
/// within bounds.
inline BundleNoises adapted(const BundleNoises& noise, const BundleResult& result) {
  constexpr double kMemory = 0.9;                         // from pair to pair
  constexpr double kLeastNoise = 0.03, kMostNoise = 0.6;  // px
  const auto adapt = [&](double value, double scale) {
    return std::clamp(value * (kMemory + (1.0 - kMemory) * scale), kLeastNoise, kMostNoise);
  };
  BundleNoises next = noise;
  for (int level = 0; level < kLandmarkLevels; ++level) {
    next[level].pixel = adapt(noise[level].pixel, result.noise_scale[level].pixel);
    next[level].disparity = adapt(noise[level].disparity, result.noise_scale[level].disparity);
  }
  return next;
}

}  // namespace cartvo
