// Brown's lens distortion and its inverse.
#include "calib/model/brown_distortion.hpp"

#include <cmath>
#include <stdexcept>

namespace cartvo::calib {

BrownDistortion::BrownDistortion(const CameraModel& camera)
    : k1_(camera.distortion[0]),
      k2_(camera.distortion[1]),
      p1_(camera.distortion[2]),
      p2_(camera.distortion[3]),
      k3_(camera.distortion[4]),
      k4_(camera.distortion[5]),
      k5_(camera.distortion[6]),
      k6_(camera.distortion[7]),
      max_radius_(0.0) {
  constexpr double kStep = 1e-3;
  constexpr int kSteps = 20'000;  // up to r = 20: 174 degrees of view, beyond what a pinhole can hold
  for (int step = 1; step <= kSteps; ++step) {
    const double r2 = (step * kStep) * (step * kStep);
    // d(r L(r^2))/dr = L + 2 r^2 L'
    if (radialFactor(r2) + 2.0 * r2 * radialFactorSlope(r2) <= 0.0) break;
    max_radius_ = step * kStep;
  }
}

double BrownDistortion::radialFactor(double r2) const {
  return (1.0 + r2 * (k1_ + r2 * (k2_ + r2 * k3_))) / (1.0 + r2 * (k4_ + r2 * (k5_ + r2 * k6_)));
}

double BrownDistortion::radialFactorSlope(double r2) const {
  const double numerator = 1.0 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
  const double denominator = 1.0 + r2 * (k4_ + r2 * (k5_ + r2 * k6_));
  const double numerator_slope = k1_ + r2 * (2.0 * k2_ + r2 * 3.0 * k3_);
  const double denominator_slope = k4_ + r2 * (2.0 * k5_ + r2 * 3.0 * k6_);
  return (numerator_slope * denominator - numerator * denominator_slope) / (denominator * denominator);
}

NormalisedPoint BrownDistortion::distort(NormalisedPoint ideal) const {
  const double r = std::sqrt(ideal.x * ideal.x + ideal.y * ideal.y);
  if (r > max_radius_) {
    ideal.x *= max_radius_ / r;
    ideal.y *= max_radius_ / r;
  }
  return distortWithin(ideal);
}

NormalisedPoint BrownDistortion::distortWithin(NormalisedPoint ideal) const {
  const auto [x, y] = ideal;
  const double r2 = x * x + y * y;
  const double L = radialFactor(r2);
  return {x * L + 2.0 * p1_ * x * y + p2_ * (r2 + 2.0 * x * x),
          y * L + p1_ * (r2 + 2.0 * y * y) + 2.0 * p2_ * x * y};
}

NormalisedPoint BrownDistortion::undistort(NormalisedPoint distorted) const {
  constexpr int kMaxIterations = 50;
  constexpr double kConverged = 1e-24;  // squared: 1e-12 of the focal length
  NormalisedPoint ideal = distorted;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const NormalisedPoint reached = distort(ideal);
    const double error_x = distorted.x - reached.x, error_y = distorted.y - reached.y;
    if (error_x * error_x + error_y * error_y < kConverged) return ideal;
    const auto [x, y] = ideal;
    const double r2 = x * x + y * y;
    const double L = radialFactor(r2), slope = radialFactorSlope(r2);
    const double J_xx = L + 2.0 * x * x * slope + 2.0 * p1_ * y + 6.0 * p2_ * x;
    const double J_yy = L + 2.0 * y * y * slope + 6.0 * p1_ * y + 2.0 * p2_ * x;
    const double J_xy = 2.0 * x * y * slope + 2.0 * p1_ * x + 2.0 * p2_ * y;
    const double determinant = J_xx * J_yy - J_xy * J_xy;
    if (!(determinant > 0.0)) break;
    ideal.x += (J_yy * error_x - J_xy * error_y) / determinant;
    ideal.y += (J_xx * error_y - J_xy * error_x) / determinant;
  }
  throw std::invalid_argument(
      "the lens distortion folds within the image: its coefficients do not fit the camera, or the lens is "
      "wider "
      "than Brown's model can hold");
}

}  // namespace cartvo::calib
