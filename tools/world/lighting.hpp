#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "tools/world/path.hpp"
#include "tools/world/underpass.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// Light on the campus; unit: what a white surface facing the midday sun sends back.
struct Lighting {
  /// Unit length after lightingOf(). Shadows are hard: the few rays that a picture can afford would make
  /// grain of a penumbra, and grain moves with no surface.
  Eigen::Vector3f to_sun{0.45F, 0.55F, 0.70F};
  float sun = 0.85F;     ///< direct light on a surface facing it; 0: no shadows
  float sky = 0.23F;     ///< from above, on a level surface
  float ground = 0.06F;  ///< sent back by the ground, on a downward surface
  float clouds = 0.5F;   ///< 0..1
  std::uint32_t seed = 0;
  bool glare = false;                  ///< the sun's disc and the bright sky around it can be seen
  std::vector<Underpass> underpasses;  ///< where less of the sky is seen

  /// The share of sky and ground that is seen from a place.
  float openness(const Eigen::Vector3f& place) const {
    float share = 1.0F;
    for (const Underpass& underpass : underpasses)
      share *= underpass.openness(place);
    return share;
  }

  /// Diffuse light from sky and ground on a surface facing `normal`.
  float ambient(const Eigen::Vector3f& normal) const {
    const float up = 0.5F + 0.5F * normal.z();
    return sky * up + ground * (1.0F - up);
  }
};

Lighting lightingOf(const WorldSettings& settings, const Path& path);

/// What is seen along `direction` (need not be of unit length) where nothing stands: clouds and, near the
/// horizon, far wooded hills; at infinity. `footprint`: the pixel's angle, rad.
float skyRadiance(const Lighting& lighting, const Eigen::Vector3f& direction, float footprint);

}  // namespace cartvo::world
