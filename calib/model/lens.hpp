#pragma once

#include <Eigen/Core>
#include <variant>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// Normalised image coordinates: (x/z, y/z), a point on the image plane at distance 1 from the camera.
struct NormalisedPoint {
  double x = 0.0, y = 0.0;
};

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

/// Brown's distortion (thesis 4.5-4.7 with L(r) = 1 + k1 r^2 + k2 r^4, extended by k3, OpenCV's rational
/// denominator k4 k5 k6 and the tangential p1 p2). It is limited to the radius where it is invertible:
/// further out the polynomial turns back, and two ideal points would have the same image.
class BrownDistortion {
 public:
  explicit BrownDistortion(const CameraModel& camera);

  /// The distorted position of an ideal point. A point beyond `maxRadius` is moved back to it first.
  NormalisedPoint distort(NormalisedPoint ideal) const;

  /// The ideal point of a distorted position, by Newton's method. Throws std::invalid_argument if there is
  /// none, because the distortion folds at a smaller radius.
  NormalisedPoint undistort(NormalisedPoint distorted) const;

  /// Ideal radius up to which the distorted radius grows with the ideal one.
  double maxRadius() const { return max_radius_; }

 private:
  double radialFactor(double r2) const;
  double radialFactorSlope(double r2) const;
  NormalisedPoint distortWithin(NormalisedPoint ideal) const;

  double k1_, k2_, p1_, p2_, k3_, k4_, k5_, k6_;
  double max_radius_;
};

/// The distortion of a camera's lens, of either model: rays to distorted normalised coordinates (before focal
/// length and principal point) and back. Results are bit-identical on every machine.
class Lens {
 public:
  explicit Lens(const CameraModel& camera);

  /// The distorted position of a ray (camera axes, any length). A ray outside the lens' field of view is
  /// moved to its rim.
  NormalisedPoint distort(const Eigen::Vector3d& ray) const;

  /// The ray (camera axes, any length) of a distorted position. Beyond the field of view, Brown's model
  /// throws std::invalid_argument, and a wide lens returns the ray at its rim.
  Eigen::Vector3d undistort(NormalisedPoint distorted) const;

 private:
  std::variant<BrownDistortion, WideDistortion> distortion_;
};

}  // namespace cartvo::calib
