#pragma once

#include <Eigen/Core>
#include <optional>

#include "tools/evaluate/association.hpp"

namespace cartvo {

/// The constant rotation from the estimate's axes to the truth's under which the translations over short
/// segments (kShortSegments) agree best, as a rotation vector (rad, axes of the camera or the body). A truth
/// that other sensors measured is the camera's by the calibration of their mounting, and where that is off by
/// an angle, each motion ends beside the true one by that angle times its length: no odometry can know.
/// Of a path that is straight to some six degrees the rotation about it is not told, and taken to be none.
/// Nothing if the path is too short for a segment.
std::optional<Eigen::Vector3d> axesRotation(const AssociatedTrajectories& associated);

/// The estimate as it would be in axes turned by so much; it starts at the identity.
Trajectory inTurnedAxes(const Trajectory& estimate, const Eigen::Vector3d& rotation);

}  // namespace cartvo
