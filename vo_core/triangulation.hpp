#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "vo_core/reprojection.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// An inverse depth by two cameras at their two instants.
struct Triangulation {
  double inverse_depth = 0.0;  ///< 1/m, along the left camera's z axis
  double lever = 0.0;          ///< m: by how much of the focal length the right pixel moves for each 1/m
};

/// The inverse depth at which the right camera sees what the left one sees at `left`, px, where it did, at
/// `right`. From y = R b + rho t, linear in rho. Nothing in the direction of the motion between the cameras.
inline std::optional<Triangulation> triangulate(const StereoCamera& camera,
                                                const Eigen::Isometry3d& T_right_left,
                                                const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
  const Eigen::Vector3d turned = T_right_left.linear() * bearingOf(camera, left);
  const Eigen::Vector3d t = T_right_left.translation();
  const Eigen::Vector2d seen = bearingOf(camera, right).head<2>();
  const Eigen::Vector2d lever = t.head<2>() - seen * t.z();
  const double square = lever.squaredNorm();
  if (!(square > 1e-8)) return std::nullopt;
  return Triangulation{lever.dot(seen * turned.z() - turned.head<2>()) / square, std::sqrt(square)};
}

}  // namespace cartvo
