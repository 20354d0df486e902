// Projections of landmarks, and their derivatives by poses and depths.
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {

Eigen::Isometry3d leftFromRight(double baseline) {
  Eigen::Isometry3d T_left_right = Eigen::Isometry3d::Identity();
  T_left_right.translation().x() = baseline;
  return T_left_right;
}

Projection projectLandmark(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                           const Eigen::Vector3d& bearing, double inverse_depth) {
  Projection projection;
  projection.ray = T_camera_anchor.linear() * bearing + inverse_depth * T_camera_anchor.translation();
  if (!(projection.ray.z() > kNearestRay)) return projection;
  projection.valid = true;
  projection.pixel = project(camera, projection.ray);
  return projection;
}

ProjectionJacobians projectionJacobians(const StereoCamera& camera, const Eigen::Isometry3d& T_camera_anchor,
                                        double inverse_depth, const Projection& projection) {
  const Eigen::Vector3d& y = projection.ray;
  const double scale = camera.focal_length / y.z();
  Eigen::Matrix<double, 2, 3> by_ray;
  by_ray << scale, 0.0, -scale * y.x() / y.z(), 0.0, scale, -scale * y.y() / y.z();

  ProjectionJacobians jacobians;
  jacobians.by_camera.leftCols<3>() = -inverse_depth * by_ray;
  jacobians.by_camera.rightCols<3>() = by_ray * skew(y);
  jacobians.by_inverse_depth = by_ray * T_camera_anchor.translation();
  return jacobians;
}

}  // namespace cartvo::vo
