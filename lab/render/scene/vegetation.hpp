#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"

namespace cartvo::world {

/// Level of detail of a tree.
enum class Detail : std::uint8_t {
  leaves,  ///< near the path: single leaves
  sprays,  ///< far away: about a quarter as many leaves, each a spray of leaves
};

/// A tree of about 8 m with trunk, branches and leaves; its foot is the origin.
Mesh makeTree(std::uint32_t seed, Detail detail);

/// A bush of about 1.2 m; its foot is the origin.
Mesh makeBush(std::uint32_t seed);

/// A tuft of grass and weeds of about 0.3 m; its foot is the origin.
Mesh makeTuft(std::uint32_t seed);

/// Adds a clipped hedge from `from` to `to`, campus coordinates in m.
void addHedge(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed,
              const Terrain& terrain);

/// A piece of a clipped hedge, `length` m along x from the origin, `height` m tall.
Mesh makeHedgePiece(std::uint32_t seed, double length, double height);

/// Some fallen leaves above a square of 2 m around the origin, up to 0.5 m high.
Mesh makeBlownLeaves(std::uint32_t seed);

}  // namespace cartvo::world
