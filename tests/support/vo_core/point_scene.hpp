#pragma once

#include <vector>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/thesis/motion_estimator.hpp"

namespace cartvo::test {

inline const vo::StereoCamera kSceneCamera{480.0, 340.0, 210.0, 0.3, 680, 420};
constexpr double kPixelNoise = 0.2, kDisparityNoise = 0.3;

/// Point as the camera measures it: with noise of pixel and disparity.
inline Eigen::Vector3d measured(const Eigen::Vector3d& point, Noise& noise) {
  const Eigen::Vector2d pixel = vo::project(kSceneCamera, point);
  const double disparity = kSceneCamera.focal_length * kSceneCamera.baseline / point.z();
  const double right =
      kPixelNoise * noise.gaussian();  // one by one: the evaluation order of arguments is unspecified
  const Eigen::Vector2d offset(right, kPixelNoise * noise.gaussian());
  return vo::triangulate(kSceneCamera, {pixel + offset, disparity + kDisparityNoise * noise.gaussian()});
}

inline Eigen::Matrix3d covarianceOf(const Eigen::Vector3d& point) {
  return vo::pointCovariance(kSceneCamera, point, kPixelNoise, kDisparityNoise);
}

/// Points in view, 4 to 30 m away.
inline std::vector<Eigen::Vector3d> scatter(int count, Noise& noise) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double z = 4.0 + 26.0 * noise.uniform();
    const double x = (noise.uniform() - 0.5) * z;
    points.emplace_back(x, (noise.uniform() - 0.5) * 0.6 * z, z);
  }
  return points;
}

inline Eigen::Isometry3d forwardMotion() {
  vo::Vector6d vector;
  vector << 0.03, -0.02, 0.4, 0.01, -0.02, 0.005;
  return vo::motionFromVector(vector);
}

}  // namespace cartvo::test
