#pragma once

#include "calib/normalised_point.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// Brown's distortion (thesis 4.5-4.7 with L(r) = 1 + k1 r^2 + k2 r^4, extended by k3, OpenCV's rational
/// denominator k4 k5 k6 and the tangential p1 p2), limited to the part of the plane where it can be undone: a
/// polynomial turns back somewhere, and what lies beyond would be seen twice.
class BrownDistortion {
 public:
  explicit BrownDistortion(const CameraModel& camera);

  /// Where the lens moves an ideal point. Points beyond `largestRadius` are taken back to it first.
  NormalisedPoint distort(NormalisedPoint ideal) const;

  /// The ideal point that the lens moves to `distorted`, by Newton's method. Throws std::invalid_argument if
  /// there is none: the distortion folds before it reaches this far.
  NormalisedPoint undistort(NormalisedPoint distorted) const;

  /// Up to here the distorted radius grows with the ideal one.
  double largestRadius() const { return largest_radius_; }

 private:
  double radialFactor(double r2) const;
  double radialFactorSlope(double r2) const;
  NormalisedPoint distortWithin(NormalisedPoint ideal) const;

  double k1_, k2_, p1_, p2_, k3_, k4_, k5_, k6_;
  double largest_radius_;
};

}  // namespace cartvo
