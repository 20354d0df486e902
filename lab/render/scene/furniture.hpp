#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"

namespace cartvo::world {

/// Street furniture; the foot of each mesh is the origin.
Mesh makeLampPost();
Mesh makeSign(std::uint32_t seed);
Mesh makeBollard();
Mesh makeBench();
Mesh makeBin();

/// A piece of a railing along x from the origin: a post, two rails and thin bars at equal distances.
Mesh makeRailingPiece(double length);

/// Adds a picket fence from `from` to `to`, campus coordinates in m.
void addFence(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed,
              const Terrain& terrain);

/// Adds a brick garden wall with a coping from `from` to `to`.
void addGardenWall(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed,
                   const Terrain& terrain);

/// Adds a parking garage around the path to an empty campus: a level floor, walls, a low ceiling with beams,
/// and along each straight aisle columns and bays with parked cars.
void addGarage(Campus& campus, const Path& path, std::uint64_t seed);

}  // namespace cartvo::world
