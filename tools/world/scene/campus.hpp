#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tools/world/scene/building.hpp"
#include "tools/world/scene/mesh.hpp"
#include "tools/world/scene/path.hpp"
#include "tools/world/scene/road.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// One placement of a mesh on the campus, with its own texture seed and brightness.
struct Instance {
  std::uint32_t mesh = 0;                                   ///< index into Campus::meshes
  Eigen::Affine3f placement = Eigen::Affine3f::Identity();  ///< mesh to campus, m
  std::uint32_t seed = 0;   ///< mixed into the seeds of its surfaces; 0: unchanged
  float tone_shift = 0.0F;  ///< added to the tone of paint, cloth and leaves
  bool moving = false;
};

/// The static scene: the ground with its road, houses, trees, fences, parked cars.
struct Campus {
  RoadProfile road;
  std::vector<Mesh> meshes;  ///< the first holds everything that occurs once
  std::vector<Instance> instances;
};

/// The closed path that the cart's rear axle follows.
Path campusPath(const WorldSettings& settings);

/// Builds the campus of the scenario and seed along `path`.
Campus buildCampus(const Path& path, const WorldSettings& settings);

}  // namespace cartvo::world
