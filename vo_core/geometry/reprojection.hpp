#pragma once

#include <Eigen/Geometry>

#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"

// Projection of landmarks into cameras, with derivatives.

namespace cartvo::vo {

/// T_left_right of the rig: the right camera lies `baseline` (m) along the left one's x axis.
Eigen::Isometry3d leftFromRight(double baseline);

constexpr double kNearestRay = 1e-3;  ///< smallest z of a ray: a landmark nearer than a thousandth of its
                                      ///< depth counts as behind the camera

/// Projection of a landmark into a camera at T_camera_anchor: y = R b + rho t, with its bearing b (z = 1) and
/// its inverse depth rho in the anchor camera. y is up to the scale rho, so that rho = 0 is a point at
/// infinity.
struct Projection {
  bool valid = false;                               ///< in front of the camera
  Eigen::Vector3d ray = Eigen::Vector3d::Zero();    ///< y
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px
};
Projection projectLandmark(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                           const Eigen::Vector3d& bearing, double inverse_depth);

/// Derivatives of a projection's pixel.
struct ProjectionJacobians {
  Eigen::Matrix<double, 2, 6> by_camera = Eigen::Matrix<double, 2, 6>::Zero();  ///< perturbation on the right
  Eigen::Vector2d by_inverse_depth = Eigen::Vector2d::Zero();
};
ProjectionJacobians projectionJacobians(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                                        double inverse_depth, const Projection& projection);

/// Direction of a pixel, z = 1.
inline Eigen::Vector3d bearingOf(const StereoCamera& camera, const Eigen::Vector2d& pixel) {
  return {(pixel.x() - camera.cx) / camera.focal_length, (pixel.y() - camera.cy) / camera.focal_length, 1.0};
}

}  // namespace cartvo::vo
