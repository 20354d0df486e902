#pragma once

#include "calib/model/normalised_point.hpp"
#include "calib/model/rig.hpp"

namespace cartvo::calib {

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

}  // namespace cartvo::calib
