#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// How the right camera is turned against the left one beyond what the rig file says, and what its lens
/// leaves over. Angles about the axes of the rectified right camera (x right, y down, z forward), rad.
///
/// Yaw and bend, which is what a decentred lens does to the columns (the p2 of Brown's model), make
/// disparities wrong by an amount that depends on the place in the image but not on the depth, and so the
/// scale of what is near disagree with the scale of what is far. Pitch and roll shift rows, which no depth
/// explains; of the columns, roll shifts those below the centre against those above.
struct RigCorrection {
  /// What disparities tell of: yaw and bend, in this order.
  static constexpr int kSize = 2;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  double yaw = 0.0;    ///< about y: positive, it looks too far to the right
  double bend = 0.0;   ///< in units of normalised coordinates
  double pitch = 0.0;  ///< about x: positive, it looks too far up
  double roll = 0.0;   ///< about z: positive, turned clockwise

  /// From the right camera's axes as they are to those of the rig file. The bend is none.
  Eigen::Matrix3d rotation() const {
    const Eigen::Vector3d vector(pitch, yaw, roll);
    const double angle = vector.norm();
    if (!(angle > 0.0)) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
  }
};

/// Where the right camera would have seen a pixel, were it as the calibration says; to first order.
inline Eigen::Vector2d correctedRight(const StereoCamera& camera, const RigCorrection& correction,
                                      const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.focal_length;
  const double y = (pixel.y() - camera.cy) / camera.focal_length;
  const auto& [yaw, bend, pitch, roll] = correction;
  return pixel +
         camera.focal_length *
             Eigen::Vector2d(yaw * (1.0 + x * x) + bend * (3.0 * x * x + y * y) - pitch * x * y - roll * y,
                             (yaw + 2.0 * bend) * x * y - pitch * (1.0 + y * y) + roll * x);
}

}  // namespace cartvo
