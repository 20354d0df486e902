#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "lab/render/surface/material.hpp"
#include "lab/render/surface/noise.hpp"

// The textures behind reflectance(), one file per family. Brightness varies by factors whose logarithm is
// about normal, as in nature; every term fades out with the pixel's footprint.
namespace cartvo::world::textures {

float asphalt(const SurfacePoint& point, const TextureStyle& style);
float kerb(const SurfacePoint& point, const TextureStyle& style);
float pavement(const SurfacePoint& point, const TextureStyle& style);
float grass(const SurfacePoint& point, const TextureStyle& style);

float brick(const SurfacePoint& point, const TextureStyle& style);
float concrete(const SurfacePoint& point, const TextureStyle& style);
float plaster(const SurfacePoint& point, const TextureStyle& style);
float window(const SurfacePoint& point, const TextureStyle& style);
float door(const SurfacePoint& point, const TextureStyle& style);
float roof(const SurfacePoint& point, const TextureStyle& style);

float wood(const SurfacePoint& point, const TextureStyle& style);
float metal(const SurfacePoint& point, const TextureStyle& style);
float bark(const SurfacePoint& point, const TextureStyle& style);
float leaf(const SurfacePoint& point, const TextureStyle& style);
float paint(const SurfacePoint& point, const TextureStyle& style);
float glass(const SurfacePoint& point, const TextureStyle& style);
float rubber(const SurfacePoint& point, const TextureStyle& style);
float cloth(const SurfacePoint& point, const TextureStyle& style);
float sign(const SurfacePoint& point, const TextureStyle& style);

/// exp(exponent) with the exponent limited to [-2, 1.2], the range of paint and dirt. The integer power of
/// two goes into the float's exponent, the rest through a polynomial: relative error below 3e-6, faster than
/// expf.
inline float clampedExp(float exponent) {
  const float power = 1.44269504F * std::clamp(exponent, -2.0F, 1.2F);
  const auto whole = static_cast<std::int32_t>(power + 8.5F) - 8;  // to the nearest
  const float x = 0.69314718F * (power - static_cast<float>(whole));
  const float rest =
      1.0F + x * (1.0F + x * (0.5F + x * (1.0F / 6.0F + x * (1.0F / 24.0F + x * (1.0F / 120.0F)))));
  return rest * std::bit_cast<float>((whole + 127) << 23);
}

/// A noise factor on the reflectance whose logarithm has standard deviation `contrast` over the surface.
inline float noiseFactor(const SurfacePoint& point, const NoiseBand& band, float contrast,
                         std::uint32_t salt) {
  return clampedExp(contrast *
                    noise(point.u, point.v, point.footprint, band, point.seed * 0x9e3779b1U + salt));
}

/// Linear interpolation from `a` to `b`.
inline float mix(float a, float b, float share_of_b) {
  return a + (b - a) * share_of_b;
}

}  // namespace cartvo::world::textures
