#pragma once

#include <cstdint>

namespace cartvo::world {

/// What surfaces are made of. Each has a procedural texture in its surface's own coordinates.
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

/// Where a material is looked at: the centre of a box on its surface.
struct SurfacePoint {
  float u = 0.0F;  ///< surface coordinates, m (asphalt: along and left of the road's guide line)
  float v = 0.0F;
  float x = 0.0F;  ///< position on the campus, m (of use for what is fixed only)
  float y = 0.0F;
  float z = 0.0F;
  float footprint = 0.01F;  ///< the box' mean width, m
  float width_u = 0.01F;    ///< and its widths along u and v, m
  float width_v = 0.01F;
  std::uint32_t seed = 0;
  float tone = 0.5F;
};

/// How rich the textures are: 1 as in life; less for the scenario that starves the odometry.
struct TextureStyle {
  float contrast = 1.0F;
  std::uint32_t seed = 0;
};

/// The share of light that the surface sends back, 0..1, averaged over the point's box.
float reflectance(Material material, const SurfacePoint& point, const TextureStyle& style);

}  // namespace cartvo::world
