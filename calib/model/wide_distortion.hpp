#pragma once

#include <Eigen/Core>

#include "calib/model/normalised_point.hpp"
#include "calib/model/rig.hpp"

namespace cartvo::calib {

// Arc tangent and tangent with bit-identical results on every machine. Those of the C library differ in the
// last bits; these use only additions, multiplications, divisions and square roots, which IEEE 754 defines to
// the last bit.

/// The arc tangent of x >= 0, rad. Relative error below 4e-15.
double portableArcTangent(double x);

/// The tangent of an angle from 0 to 1.56 rad. Relative error below 1e-13 up to 1.5 rad.
double portableTangent(double angle);

/// Distortion of a wide-angle or fisheye lens (J. Kannala and S. S. Brandt, "A generic camera model and
/// calibration method for conventional, wide-angle, and fish-eye lenses", 2006, in the form of OpenCV's
/// fisheye module): a ray at the angle a from the axis is imaged at the radius a (1 + k1 a^2 + k2 a^4 + k3
/// a^6 + k4 a^8). The field of view may exceed 180 degrees; it ends at the angle where the polynomial turns
/// back.
class WideDistortion {
 public:
  explicit WideDistortion(const CameraModel& camera);

  /// The distorted position of a ray (not zero, any length). A ray beyond `maxAngle` is moved back to it
  /// first.
  NormalisedPoint distort(const Eigen::Vector3d& ray) const;

  /// The unit ray of a distorted position. Beyond the field of view, the outermost ray in that direction.
  Eigen::Vector3d undistort(NormalisedPoint distorted) const;

  /// Angle from the axis up to which the radius grows with the angle, rad; at most 3.1.
  double maxAngle() const { return max_angle_; }

 private:
  double radius(double angle) const;
  double radiusSlope(double angle) const;
  double angleAt(double radius) const;

  double k1_, k2_, k3_, k4_;
  double max_angle_;
};

}  // namespace cartvo::calib
