#pragma once

#include <Eigen/Core>
#include <vector>

#include "lab/render/scene/building.hpp"
#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/scene/road.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// A stretch of road below a wide bridge; light enters only at its ends.
struct Underpass {
  double from = 0.0;             ///< start, m along the path
  double to = 0.0;               ///< end, m along the path
  Eigen::Vector2f middle{0, 0};  ///< m, campus axes
  Eigen::Vector2f along{1, 0};   ///< direction of the road, unit length
  float half_length = 0.0F;      ///< m
  float left = 0.0F;             ///< left wall, m left of the path
  float right = 0.0F;            ///< right wall, m left of the path (negative)
  float ceiling = 0.0F;          ///< m, height in campus axes; the floor is nearly level

  /// Fraction of the light of sky and ground that reaches `place`; 1 outside.
  float openness(const Eigen::Vector3f& place) const;
};

/// The underpasses of the scenario, on straight stretches of the path, and its tunnel; none in most
/// scenarios.
std::vector<Underpass> underpasses(const Path& path, const WorldSettings& settings);

/// Adds the walls, the ceiling and the bridge to `mesh`.
void addUnderpass(Mesh& mesh, const Underpass& underpass, const Path& path, const Terrain& terrain);

/// The ground plan of an underpass, for collision checks with buildings.
Building groundPlan(const Underpass& underpass);

}  // namespace cartvo::world
