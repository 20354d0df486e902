#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "tools/world/mesh.hpp"

namespace cartvo::world {

/// How closely a tree will ever be looked at.
enum class Detail : std::uint8_t {
  leaves,  ///< from near: single leaves
  sprays,  ///< from afar: a quarter as many, each a spray of leaves
};

/// A tree with trunk, branches and leaves, its foot at the origin, about 8 m high.
Mesh makeTree(std::uint32_t seed, Detail detail);

/// A bush of about 1.2 m.
Mesh makeBush(std::uint32_t seed);

/// A tuft of high grass and weeds, some 0.3 m high.
Mesh makeTuft(std::uint32_t seed);

/// A clipped hedge from `from` to `to`.
void addHedge(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed);

}  // namespace cartvo::world
