#pragma once

#include <Eigen/Core>
#include <optional>

#include "tools/evaluate/association.hpp"

namespace cartvo {

/// Constant rotation from the estimate's axes to the truth's axes for which the translations over short
/// segments (kShortSegments) agree best, as a rotation vector (rad, axes of the camera or the body). A truth
/// measured by other sensors depends on the calibration of their mounting: an error of that angle displaces
/// the end of each motion by the angle times its length, which no odometry can observe. The rotation about a
/// path that is straight within about six degrees is not observable and set to zero. Empty if the path is too
/// short for a segment.
std::optional<Eigen::Vector3d> axesRotation(const AssociatedTrajectories& associated);

/// Rotates the estimate's axes by `rotation`; the result starts at the identity.
Trajectory rotateAxes(const Trajectory& estimate, const Eigen::Vector3d& rotation);

}  // namespace cartvo
