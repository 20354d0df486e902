#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lab/render/surface/lighting.hpp"
#include "lab/render/surface/material.hpp"
#include "lab/render/tracing/scene.hpp"

namespace cartvo::world {

/// The part of one surface that one pixel shows.
struct SurfaceHit {
  std::uint32_t instance = 0;
  std::uint32_t quad = 0;
  float time = 0.0F;                  ///< see View::timeOf
  Eigen::Vector2f uv{0, 0};           ///< texture coordinates, m
  Eigen::Vector3f position{0, 0, 0};  ///< m, campus axes
  Eigen::Vector3f normal{0, 0, 1};    ///< unit length, toward the camera
  float depth = 1.0F;                 ///< m along the camera's z axis
  float sunlit = 0.0F;                ///< fraction of the part that the sun reaches, 0..1
};

/// Radiance of the surface along -`direction`; `pixel_angle`: width of the pixel on the plane z = 1.
float surfaceRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                      const SurfaceHit& hit, const Eigen::Vector3f& direction, float pixel_angle);

/// Cosine factor of the sun's light on a surface; leaves also transmit light from behind.
float sunFactor(Material material, const Eigen::Vector3f& normal, const Eigen::Vector3f& to_sun);

}  // namespace cartvo::world
