#pragma once

#include <Eigen/Geometry>

#include "tools/world/scene/path.hpp"

namespace cartvo::world {

/// Height of the ground at campus position (x, y), m: a smooth sum of sines.
double terrainHeight(double x, double y);

/// Pose on the ground at `point` of a path, `lateral` m to its left, of a vehicle with axles `wheelbase` m
/// apart: x along the path, y left, z up; origin below the rear axle.
Eigen::Isometry3d groundPose(const PathPoint& point, double lateral, double wheelbase);

}  // namespace cartvo::world
