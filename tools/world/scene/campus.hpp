#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tools/world/scene/building.hpp"
#include "tools/world/scene/instance.hpp"
#include "tools/world/scene/mesh.hpp"
#include "tools/world/scene/path.hpp"
#include "tools/world/scene/road.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

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
