#pragma once

#include <Eigen/Geometry>
#include <array>

#include "lab/render/scene/mesh.hpp"

namespace cartvo::world {

/// Parts of a walking person. Legs and arms have their joint at the origin.
Mesh makeTorso();
Mesh makeLeg();
Mesh makeArm();

/// Placements of torso, left leg, right leg, left arm, right arm in the person's axes (x ahead, z up, origin
/// on the ground) after `walked` m.
std::array<Eigen::Isometry3d, 5> limbPlacements(double walked);

}  // namespace cartvo::world
