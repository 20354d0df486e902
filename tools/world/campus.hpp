#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tools/world/building.hpp"
#include "tools/world/mesh.hpp"
#include "tools/world/path.hpp"
#include "tools/world/road.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// A mesh put somewhere, with its own colours.
struct Instance {
  std::uint32_t mesh = 0;  ///< index
  Eigen::Affine3f placement = Eigen::Affine3f::Identity();
  std::uint32_t seed = 0;   ///< mixed into the seeds of its surfaces
  float tone_shift = 0.0F;  ///< of paint, cloth and leaves
  bool moving = false;
};

/// Everything that stands still: the ground with its road, houses, trees, fences, parked cars.
struct Campus {
  RoadProfile road;
  std::vector<Mesh> meshes;  ///< the first holds all that is there once
  std::vector<Instance> instances;
};

/// The line that the cart's rear axle follows, closed.
Path campusPath(const WorldSettings& settings);

/// Lays out a campus along the path.
Campus buildCampus(const Path& path, const WorldSettings& settings);

}  // namespace cartvo::world
