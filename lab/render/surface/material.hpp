#pragma once

#include <cstdint>

namespace cartvo::world {

/// Surface materials. Each has a procedural texture in surface coordinates.
enum class Material : std::uint8_t {
  asphalt,
  kerb,
  pavement,
  grass,
  brick,
  concrete,
  plaster,
  window,
  door,
  roof,
  wood,
  metal,
  bark,
  leaf,
  paint,
  glass,
  rubber,
  cloth,
  sign,
};

/// A box-shaped sample on a surface: its centre and size.
struct SurfacePoint {
  float u = 0.0F;  ///< surface coordinates, m (asphalt: along the path and to its left)
  float v = 0.0F;
  float x = 0.0F;  ///< position on the campus, m (meaningful for static surfaces only)
  float y = 0.0F;
  float z = 0.0F;
  float footprint = 0.01F;  ///< mean width of the box, m
  float width_u = 0.01F;    ///< widths of the box along u and v, m
  float width_v = 0.01F;
  std::uint32_t seed = 0;
  float tone = 0.5F;
};

/// Strength of all textures.
struct TextureStyle {
  float contrast = 1.0F;  ///< 1: natural; less for scenarios with little texture
  std::uint32_t seed = 0;
};

/// Reflectance of the material, 0..1, averaged over the box of `point`.
float reflectance(Material material, const SurfacePoint& point, const TextureStyle& style);

}  // namespace cartvo::world
