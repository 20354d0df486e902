#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo::vo {

/// Inverse depth from two cameras at their own exposure instants.
struct Triangulation {
  double inverse_depth = 0.0;  ///< 1/m, along the left camera's z axis
  double sensitivity = 0.0;    ///< m, motion of the right pixel in focal lengths per 1/m of inverse depth
};

/// Triangulates the inverse depth rho of a point from its pixels `left` and `right`, px: a linear equation
/// with the ray y = R b + rho t. Returns nothing for a point in the direction of the motion between the
/// cameras.
inline std::optional<Triangulation> triangulate(const StereoCamera& camera,
                                                const Eigen::Isometry3d& T_right_left,
                                                const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
  const Eigen::Vector3d turned = T_right_left.linear() * bearingOf(camera, left);
  const Eigen::Vector3d t = T_right_left.translation();
  const Eigen::Vector2d seen = bearingOf(camera, right).head<2>();
  const Eigen::Vector2d sensitivity = t.head<2>() - seen * t.z();
  const double square = sensitivity.squaredNorm();
  if (!(square > 1e-8)) return std::nullopt;
  return Triangulation{sensitivity.dot(seen * turned.z() - turned.head<2>()) / square, std::sqrt(square)};
}

}  // namespace cartvo::vo
