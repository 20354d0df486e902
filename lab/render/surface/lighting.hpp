#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "lab/render/scene/path.hpp"
#include "lab/render/scene/underpass.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Light sources of the campus. Unit of radiance: a white surface that faces the midday sun is 1.
struct Lighting {
  /// Direction to the sun; unit length after buildLighting(). Shadows are hard: with few rays per pixel a
  /// penumbra would become grain, and grain moves with no surface.
  Eigen::Vector3f to_sun{0.45F, 0.55F, 0.70F};
  float sun = 0.85F;     ///< direct light on a surface that faces the sun; 0: no shadows
  float sky = 0.23F;     ///< light of the sky on a level surface
  float ground = 0.06F;  ///< light reflected by the ground onto a downward surface
  float clouds = 0.5F;   ///< cloud cover, 0..1
  std::uint32_t seed = 0;
  bool glare = false;                  ///< whether the sun's disc and its bright haze are drawn
  std::vector<Underpass> underpasses;  ///< attenuate the light of the sky
  float lamp_spacing = 0.0F;           ///< m between the lamps of a ceiling; 0: none

  /// Fraction of the light of sky, ground and lamps that reaches `place`, 0..1.
  float openness(const Eigen::Vector3f& place) const;

  /// Diffuse light from sky and ground on a surface facing `normal`.
  float ambient(const Eigen::Vector3f& normal) const {
    const float up = 0.5F + 0.5F * normal.z();
    return sky * up + ground * (1.0F - up);
  }
};

/// The light of a scenario and seed; `path` gives the direction of the glare and the underpasses.
Lighting buildLighting(const WorldSettings& settings, const Path& path);

/// Radiance of the background at infinity along `direction` (any length): clouds and, near the horizon,
/// wooded hills. `footprint`: the pixel's angle, rad.
float skyRadiance(const Lighting& lighting, const Eigen::Vector3f& direction, float footprint);

}  // namespace cartvo::world
