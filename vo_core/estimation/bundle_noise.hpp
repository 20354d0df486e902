#pragma once

#include <algorithm>

#include "vo_core/estimation/bundle_adjustment.hpp"

namespace cartvo::vo {

/// Updates the assumed noise by the residuals of an adjusted window: exponential average over
/// `correlated_pairs`, clamped.
inline BundleNoises adapted(const BundleNoises& noise, const BundleResult& result, double correlated_pairs) {
  constexpr double kMinimumNoise = 0.03, kMaximumNoise = 0.6;  // px
  const auto adapt = [&](double value, double scale) {
    return std::clamp(value * (1.0 + (scale - 1.0) / correlated_pairs), kMinimumNoise, kMaximumNoise);
  };
  BundleNoises next = noise;
  for (int level = 0; level < kLandmarkLevels; ++level) {
    next[level].pixel = adapt(noise[level].pixel, result.noise_scale[level].pixel);
    next[level].disparity = adapt(noise[level].disparity, result.noise_scale[level].disparity);
  }
  return next;
}

}  // namespace cartvo::vo
