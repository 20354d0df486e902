#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "tools/world/lighting.hpp"
#include "tools/world/material.hpp"
#include "tools/world/scene.hpp"

namespace cartvo::world {

/// A piece of one surface seen through one pixel.
struct SurfaceHit {
  std::uint32_t instance = 0;
  std::uint32_t quad = 0;
  Eigen::Vector2f uv{0, 0};           ///< texture coordinates, m
  Eigen::Vector3f position{0, 0, 0};  ///< on the campus, m
  Eigen::Vector3f normal{0, 0, 1};    ///< unit length, toward the viewer
  float depth = 1.0F;                 ///< along the camera's axis, m
  float sunlit = 0.0F;                ///< share of the piece that the sun reaches, 0..1
};

/// The light that the piece sends along -`direction`; `pixel_angle` is the pixel's width on the plane z = 1.
float surfaceRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                      const SurfaceHit& hit, const Eigen::Vector3f& direction, float pixel_angle);

/// Share of the sun's light that arrives by the surface's slope; leaves let some through.
float sunFactor(Material material, const Eigen::Vector3f& normal, const Eigen::Vector3f& to_sun);

}  // namespace cartvo::world
