#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/world/building.hpp"
#include "tools/world/mesh.hpp"
#include "tools/world/path.hpp"
#include "tools/world/road.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// A stretch of the road below a broad bridge: dark inside, and light that comes in only at its ends.
struct Underpass {
  double from = 0.0;  ///< m along the path
  double to = 0.0;
  Eigen::Vector2f middle{0, 0};  ///< on the campus, m
  Eigen::Vector2f along{1, 0};   ///< unit length
  float half_length = 0.0F;      ///< m
  float left = 0.0F;             ///< the walls, m left of the path
  float right = 0.0F;
  float ceiling = 0.0F;  ///< m above the campus' zero; the floor is nearly level

  /// The share of the sky's and the ground's light that arrives at a place; 1 outside.
  float openness(const Eigen::Vector3f& place) const;
};

/// Where the scenario has them: on the path's straight stretches.
std::vector<Underpass> underpasses(const Path& path, const WorldSettings& settings);

/// The walls, the ceiling, and the bridge above them.
void addUnderpass(Mesh& mesh, const Underpass& underpass, const Path& path);

/// The ground that it takes.
Building groundPlan(const Underpass& underpass);

}  // namespace cartvo::world
