#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <utility>
#include <vector>

#include "lab/render/scene/building.hpp"
#include "lab/render/scene/instance.hpp"
#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/scene/road.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// The static scene: the ground with its road, houses, trees, fences, parked cars.
struct Campus {
  RoadProfile road;
  std::vector<Mesh> meshes;  ///< the first holds everything that occurs once
  std::vector<Instance> instances;

  /// Returns the mesh's index.
  std::uint32_t addMesh(Mesh mesh) {
    meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(meshes.size() - 1);
  }
};

/// The closed path that the cart's rear axle follows.
Path campusPath(const WorldSettings& settings);

/// Builds the campus of the scenario and seed along `path`.
Campus buildCampus(const Path& path, const WorldSettings& settings);

}  // namespace cartvo::world
