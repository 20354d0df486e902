#pragma once

#include <Eigen/Geometry>

#include "lab/render/scene/path.hpp"

namespace cartvo::world {

/// Height of the ground: a smooth sum of sines.
struct Terrain {
  double relief = 1.0;      ///< factor on the heights of the hills
  double land_depth = 0.0;  ///< m, by which the land beside the road lies below it

  /// Height of the road at campus position (x, y), m.
  double height(double x, double y) const;

  /// Height of the land beside the road, m.
  double landHeight(double x, double y) const { return height(x, y) - land_depth; }
};

/// Pose on the ground at `point` of a path, `lateral` m to its left, of a vehicle with axles `wheelbase` m
/// apart: x along the path, y left, z up; origin below the rear axle.
Eigen::Isometry3d groundPose(const Terrain& terrain, const PathPoint& point, double lateral,
                             double wheelbase);

}  // namespace cartvo::world
