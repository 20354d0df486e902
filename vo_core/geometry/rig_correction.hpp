#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vo_core/stereo_camera.hpp"

namespace cartvo::vo {

/// Correction of the rig's calibration: the rotation of the right camera relative to the rig file. Angles
/// about the axes of the rectified right camera (x right, y down, z forward), rad.
///
/// A yaw changes disparities by an amount that depends on the position in the image but not on the depth, so
/// that near and far points yield different scales of the motion. Pitch and roll shift the rows of matches,
/// which a depth cannot do; roll also shifts columns, in opposite directions above and below the centre.
struct RigCorrection {
  double yaw = 0.0;    ///< about y; positive: the camera looks too far to the right
  double pitch = 0.0;  ///< about x; positive: the camera looks too far up
  double roll = 0.0;   ///< about z; positive: the camera is turned clockwise

  /// Rotation from the right camera's true axes to those of the rig file.
  Eigen::Matrix3d rotation() const {
    const Eigen::Vector3d vector(pitch, yaw, roll);
    const double angle = vector.norm();
    if (!(angle > 0.0)) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
  }
};

/// The value times the least squares factor m^2 / (m^2 + variance) on a measurement of m, with value^2 -
/// variance in place of m^2: the non-negative garrote (H. Gao, "Wavelet shrinkage denoising using the
/// non-negative garrote", 1998), zero for values below their standard deviation.
inline double shrunk(double value, double variance) {
  return value * value <= variance ? 0.0 : value - variance / value;
}

/// Corrected right pixel: where a right camera as calibrated would observe the point.
/// RigCorrection::rotation() to the second order, which is exact to 0.01 px for 2 degrees.
inline Eigen::Vector2d correctedRight(const StereoCamera& camera, const RigCorrection& correction,
                                      const Eigen::Vector2d& pixel) {
  const Eigen::Vector3d turn(correction.pitch, correction.yaw, correction.roll);
  const Eigen::Vector3d bearing((pixel.x() - camera.cx) / camera.focal_length,
                                (pixel.y() - camera.cy) / camera.focal_length, 1.0);
  const Eigen::Vector3d turned = turn.cross(bearing);
  const Eigen::Vector3d ray = bearing + turned + 0.5 * turn.cross(turned);
  const double scale = camera.focal_length / ray.z();
  return {camera.cx + scale * ray.x(), camera.cy + scale * ray.y()};
}

}  // namespace cartvo::vo
