#pragma once

#include <Eigen/Geometry>
#include <array>

#include "tools/world/mesh.hpp"

namespace cartvo::world {

/// A walking person: a body and two limbs of each kind that swing from their joints.
Mesh makeTorso();
Mesh makeLeg();
Mesh makeArm();

/// Placements of torso, left leg, right leg, left arm, right arm in the person's axes (x ahead, z up, origin
/// on the ground), `walked` metres into the walk.
std::array<Eigen::Isometry3d, 5> limbPlacements(double walked);

}  // namespace cartvo::world
