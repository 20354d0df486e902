#pragma once

#include <algorithm>

#include "vo_core/estimation/bundle_adjustment.hpp"

namespace cartvo::vo {

/// Updates the assumed noise by the residuals of an adjusted window: exponential average, clamped.
inline BundleNoises adapted(const BundleNoises& noise, const BundleResult& result) {
  constexpr double kMemory = 0.9;                              // weight of the previous estimate, per pair
  constexpr double kMinimumNoise = 0.03, kMaximumNoise = 0.6;  // px
  const auto adapt = [&](double value, double scale) {
    return std::clamp(value * (kMemory + (1.0 - kMemory) * scale), kMinimumNoise, kMaximumNoise);
  };
  BundleNoises next = noise;
  for (int level = 0; level < kLandmarkLevels; ++level) {
    next[level].pixel = adapt(noise[level].pixel, result.noise_scale[level].pixel);
    next[level].disparity = adapt(noise[level].disparity, result.noise_scale[level].disparity);
  }
  return next;
}

}  // namespace cartvo::vo
