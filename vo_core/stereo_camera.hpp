#pragma once

#include <Eigen/Core>

namespace cartvo::vo {

/// A rectified stereo camera: both images share focal length and principal point, rows correspond.
struct StereoCamera {
  double focal_length = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< principal point, px; pixel centres at integer coordinates
  double baseline = 0.0;      ///< m
  int width = 0, height = 0;  ///< px
};

/// Throws std::invalid_argument that names the first value out of range.
void validate(const StereoCamera& camera);

/// Observation of a point by one pair: pixel in the left image (px) and disparity x_left - x_right (px).
struct StereoMeasurement {
  Eigen::Vector2d left = Eigen::Vector2d::Zero();
  double disparity = 0.0;
};

/// Point in the left camera's axes (m): Z = f b / d, X = (x - cx) Z / f, Y = (y - cy) Z / f (thesis 4.1-4.4,
/// 4.14). The disparity must be positive.
Eigen::Vector3d triangulate(const StereoCamera& camera, const StereoMeasurement& measurement);

/// Pixel of a point in front of the left camera, px.
Eigen::Vector2d project(const StereoCamera& camera, const Eigen::Vector3d& point);

/// Covariance (m^2) of the triangulated point of `point`, to first order, from the standard deviations of
/// pixel and disparity (px). It grows with the fourth power of the depth along the ray, with the second
/// across.
Eigen::Matrix3d pointCovariance(const StereoCamera& camera, const Eigen::Vector3d& point, double pixel_noise,
                                double disparity_noise);

}  // namespace cartvo::vo
