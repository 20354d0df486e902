// Kannala and Brandt's wide-angle distortion and its inverse.
#include "calib/model/wide_distortion.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::calib {

WideDistortion::WideDistortion(const CameraModel& camera)
    : k1_(camera.distortion[0]),
      k2_(camera.distortion[1]),
      k3_(camera.distortion[2]),
      k4_(camera.distortion[3]),
      max_angle_(0.0) {
  constexpr double kStep = 1e-3;
  constexpr int kSteps = 3'100;  // just below pi, where the azimuth of a ray is undefined
  for (int step = 1; step <= kSteps && radiusSlope(step * kStep) > 0.0; ++step)
    max_angle_ = step * kStep;
}

double WideDistortion::radius(double angle) const {
  const double a2 = angle * angle;
  return angle * (1.0 + a2 * (k1_ + a2 * (k2_ + a2 * (k3_ + a2 * k4_))));
}

double WideDistortion::radiusSlope(double angle) const {
  const double a2 = angle * angle;
  return 1.0 + a2 * (3.0 * k1_ + a2 * (5.0 * k2_ + a2 * (7.0 * k3_ + a2 * 9.0 * k4_)));
}

NormalisedPoint WideDistortion::distort(const Eigen::Vector3d& ray) const {
  // Written out, since the order of Eigen's summation may depend on the processor.
  const double sideways2 = ray.x() * ray.x() + ray.y() * ray.y();
  const double sideways = std::sqrt(sideways2);
  const double length = std::sqrt(sideways2 + ray.z() * ray.z());
  constexpr double kMinSine = 1e-12;  // below, sine, angle and radius are the same
  if (sideways <= kMinSine * length && ray.z() > 0.0) return {ray.x() / length, ray.y() / length};
  // tan(a/2) = sin a / (1 + cos a) holds for all angles; the denominator is 0 only straight behind.
  const double half_tangent = sideways / std::max(length + ray.z(), kMinSine * length);
  const double angle = std::min(2.0 * portableArcTangent(half_tangent), max_angle_);
  const double scale = radius(angle) / std::max(sideways, kMinSine * length);
  return {scale * ray.x(), scale * ray.y()};
}

double WideDistortion::angleAt(double target) const {
  if (target >= radius(max_angle_)) return max_angle_;
  // Newton's method, bracketed by a lower and an upper bound.
  constexpr int kMaxSteps = 100;
  double lower = 0.0, upper = max_angle_, angle = std::min(target, upper);
  for (int step = 0; step < kMaxSteps; ++step) {
    const double error = radius(angle) - target;
    (error > 0.0 ? upper : lower) = angle;
    double next = angle - error / radiusSlope(angle);
    if (!(next >= lower && next <= upper)) next = 0.5 * (lower + upper);
    const bool converged = std::abs(next - angle) <= 1e-15;
    angle = next;
    if (converged) break;
  }
  return angle;
}

Eigen::Vector3d WideDistortion::undistort(NormalisedPoint distorted) const {
  const double target = std::sqrt(distorted.x * distorted.x + distorted.y * distorted.y);
  if (target == 0.0) return {0.0, 0.0, 1.0};
  const double half_tangent = portableTangent(0.5 * angleAt(target));
  const double t2 = half_tangent * half_tangent;
  const double sine = 2.0 * half_tangent / (1.0 + t2), cosine = (1.0 - t2) / (1.0 + t2);
  return {sine * distorted.x / target, sine * distorted.y / target, cosine};
}

double portableArcTangent(double x) {
  // atan x = 2 atan(x / (1 + sqrt(1 + x^2))): four halvings reduce pi/2 to pi/32, where the first omitted
  // term of the series is 5e-19.
  constexpr int kHalvings = 4;
  for (int halving = 0; halving < kHalvings; ++halving)
    x /= 1.0 + std::sqrt(1.0 + x * x);
  const double x2 = x * x;
  double series = 0.0;
  for (int power = 15; power >= 1; power -= 2)
    series = 1.0 / power - x2 * series;
  return (1 << kHalvings) * x * series;
}

double portableTangent(double angle) {
  // The arc tangent is concave: Newton's method from below never overshoots, so it converges.
  constexpr int kMaxSteps = 60;
  double tangent = angle;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double correction = (angle - portableArcTangent(tangent)) * (1.0 + tangent * tangent);
    tangent += correction;
    if (std::abs(correction) <= 1e-15 * tangent) break;
  }
  return tangent;
}

}  // namespace cartvo::calib
