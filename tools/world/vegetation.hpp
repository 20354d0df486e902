#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "tools/world/mesh.hpp"

namespace cartvo::world {

/// A tree with trunk, branches and single leaves, its foot at the origin, about 8 m high.
Mesh makeTree(std::uint32_t seed);

/// A bush of about 1.2 m.
Mesh makeBush(std::uint32_t seed);

/// A tuft of high grass and weeds, some 0.3 m high.
Mesh makeTuft(std::uint32_t seed);

/// A clipped hedge from `from` to `to`.
void addHedge(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed);

}  // namespace cartvo::world
