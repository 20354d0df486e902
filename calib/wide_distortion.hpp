#pragma once

#include <Eigen/Core>

#include "calib/normalised_point.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// A wide lens (J. Kannala and S. S. Brandt, "A generic camera model and calibration method for conventional,
/// wide-angle, and fish-eye lenses", 2006, in the form of OpenCV's fisheye module): a ray at the angle a from
/// the axis is seen at the distance a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8) from the image's centre. Rays
/// from the side, and from behind, are seen too, up to the angle where the polynomial turns back.
class WideDistortion {
 public:
  explicit WideDistortion(const CameraModel& camera);

  /// Where a ray (not zero, any length) is seen. One beyond `largestAngle` is taken back to it first.
  NormalisedPoint distort(const Eigen::Vector3d& ray) const;

  /// The ray, of length 1, that is seen at `distorted`; beyond what the lens sees, the outermost one in that
  /// direction.
  Eigen::Vector3d undistort(NormalisedPoint distorted) const;

  /// Up to this angle from the axis, rad, the distance from the centre grows with the angle; at most 3.1.
  double largestAngle() const { return largest_angle_; }

 private:
  double radius(double angle) const;
  double radiusSlope(double angle) const;
  double angleAt(double radius) const;

  double k1_, k2_, k3_, k4_;
  double largest_angle_;
};

}  // namespace cartvo
