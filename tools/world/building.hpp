#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "tools/world/mesh.hpp"

namespace cartvo::world {

/// A house as a rectangle with storeys.
struct Building {
  Eigen::Vector2d centre{0.0, 0.0};  ///< m
  double yaw = 0.0;                  ///< of its length, rad
  double length = 16.0;              ///< m
  double depth = 11.0;               ///< m
  int storeys = 2;
  Material wall = Material::brick;
  std::uint32_t seed = 0;
};

/// Whether `point` lies within `margin` of the building's ground plan.
bool covers(const Building& building, const Eigen::Vector2d& point, double margin);

/// Walls with recessed windows, doors, sills, plinth and roof.
void addBuilding(Mesh& mesh, const Building& building);

}  // namespace cartvo::world
