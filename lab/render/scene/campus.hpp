#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <utility>
#include <vector>

#include "lab/render/scene/building.hpp"
#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/scene/road.hpp"
#include "lab/render/surface/hash.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// One placement of a mesh on the campus, with its own texture seed and brightness.
struct Instance {
  std::uint32_t mesh = 0;                                   ///< index into Campus::meshes
  Eigen::Affine3f placement = Eigen::Affine3f::Identity();  ///< mesh to campus, m
  std::uint32_t seed = 0;   ///< mixed into the seeds of its surfaces; 0: unchanged
  float tone_shift = 0.0F;  ///< added to the tone of paint, cloth and leaves
  bool moving = false;
  float sway = 0.0F;  ///< rad, to which wind bends it
};

inline Eigen::Affine3f toAffine(const Eigen::Isometry3d& pose) {
  return Eigen::Affine3f(pose.matrix().cast<float>());
}

/// An instance with a look of its own.
inline Instance paintedInstance(std::uint32_t mesh, Random& random) {
  Instance instance;
  instance.mesh = mesh;
  instance.seed = random.bits();
  instance.tone_shift = random.real(-0.45, 0.5);
  return instance;
}

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
