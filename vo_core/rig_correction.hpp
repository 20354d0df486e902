#pragma once

#include <Eigen/Core>

#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// What a calibration leaves over, as far as driving shows it: the yaw of the right camera against the left,
/// and a bend of its columns, which is what a decentred lens does (the p2 of Brown's model). Both make
/// disparities wrong by an amount that depends on the place in the image but not on the depth, and so the
/// scale of what is near disagree with the scale of what is far.
struct RigCorrection {
  static constexpr int kSize = 2;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  double yaw = 0.0;   ///< rad
  double bend = 0.0;  ///< in units of normalised coordinates
};

/// Where the right camera would have seen a pixel, were it as the calibration says.
inline Eigen::Vector2d correctedRight(const StereoCamera& camera, const RigCorrection& correction,
                                      const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.focal_length;
  const double y = (pixel.y() - camera.cy) / camera.focal_length;
  Eigen::Vector2d corrected = pixel;
  corrected.x() +=
      camera.focal_length * (correction.yaw * (1.0 + x * x) + correction.bend * (3.0 * x * x + y * y));
  return corrected;
}

/// Derivative of the corrected column by yaw and bend.
inline RigCorrection::Vector columnByCorrection(const StereoCamera& camera, const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.focal_length;
  const double y = (pixel.y() - camera.cy) / camera.focal_length;
  return camera.focal_length * RigCorrection::Vector(1.0 + x * x, 3.0 * x * x + y * y);
}

}  // namespace cartvo
