#pragma once

#include <Eigen/Geometry>

#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Motion of the body that a vibrating mount of the cameras makes: both cameras turn about the same place.
/// Twice continuously differentiable in time.
class MountShake {
 public:
  /// `mount`: the place that does not move, in body axes, m.
  MountShake(const WorldSettings& settings, const Eigen::Vector3d& mount);

  /// Pose of the shaken body in the axes of the body at rest. The identity until the end of the lead-in; the
  /// full amplitude a second later.
  Eigen::Isometry3d T_body_shaken(double seconds) const;

 private:
  Shake shake_;
  double start_ = 0.0;  ///< s
  Eigen::Vector3d mount_;
};

}  // namespace cartvo::world
