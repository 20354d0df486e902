#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"

namespace cartvo::world {

/// A house: a rectangular ground plan and a number of storeys.
struct Building {
  Eigen::Vector2d centre{0.0, 0.0};  ///< m
  double yaw = 0.0;                  ///< rad, direction of its length on the campus
  double length = 16.0;              ///< m, along `yaw`
  double depth = 11.0;               ///< m, across it
  int storeys = 2;
  Material wall = Material::brick;
  std::uint32_t seed = 0;
};

/// Whether `point` lies within `margin` of the building's ground plan.
bool covers(const Building& building, const Eigen::Vector2d& point, double margin);

/// Adds a house to `mesh`: walls with recessed windows, doors and sills, plinth and roof.
void addBuilding(Mesh& mesh, const Building& building, const Terrain& terrain);

}  // namespace cartvo::world
