#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "tools/world/mesh.hpp"

namespace cartvo::world {

/// Things along the street, each with its foot at the origin.
Mesh makeLampPost();
Mesh makeSign(std::uint32_t seed);
Mesh makeBollard();
Mesh makeBench();
Mesh makeBin();

/// A picket fence from `from` to `to`.
void addFence(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed);

/// A garden wall of brick with a coping.
void addGardenWall(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed);

}  // namespace cartvo::world
