#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "tools/world/material.hpp"
#include "tools/world/noise.hpp"

// The textures behind reflectance(), a family to a file. Shared rules: brightness varies by factors, as it
// does in nature (the logarithm is what is about normal), and every term fades with the pixel's footprint.
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

/// exp(exponent), kept within what paint and dirt can do. A whole power of two by the float's exponent, the
/// rest by a polynomial: within 3e-6, at a fraction of the library's price.
inline float factor(float exponent) {
  const float power = 1.44269504F * std::clamp(exponent, -2.0F, 1.2F);
  const auto whole = static_cast<std::int32_t>(power + 8.5F) - 8;  // to the nearest
  const float x = 0.69314718F * (power - static_cast<float>(whole));
  const float rest =
      1.0F + x * (1.0F + x * (0.5F + x * (1.0F / 6.0F + x * (1.0F / 24.0F + x * (1.0F / 120.0F)))));
  return rest * std::bit_cast<float>((whole + 127) << 23);
}

/// A factor that varies over the surface with relative deviation `contrast`.
inline float varied(const SurfacePoint& point, const NoiseBand& band, float contrast, std::uint32_t salt) {
  return factor(contrast * noise(point.u, point.v, point.footprint, band, point.seed * 0x9e3779b1U + salt));
}

inline float mix(float a, float b, float share_of_b) {
  return a + (b - a) * share_of_b;
}

}  // namespace cartvo::world::textures
