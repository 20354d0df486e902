#pragma once

#include <Eigen/Geometry>

#include "tools/world/path.hpp"

namespace cartvo::world {

/// Height of the ground, m: long gentle waves, smooth everywhere. What stands on the campus stands on it.
double terrainHeight(double x, double y);

/// On the ground at `point` of a path, `lateral` m to its left: x along the path, y left, z up from the
/// ground, for what stands or drives there with its axles `wheelbase` m apart.
Eigen::Isometry3d groundPose(const PathPoint& point, double lateral, double wheelbase);

}  // namespace cartvo::world
