// Distortion and its inverse: Brown and the wide lens.
#include "calib/model/lens.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cartvo::calib {
namespace {

std::variant<BrownDistortion, WideDistortion> distortionOf(const CameraModel& camera) {
  if (camera.lens == LensModel::wide) return WideDistortion(camera);
  return BrownDistortion(camera);
}

}  // namespace

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

Lens::Lens(const CameraModel& camera) : distortion_(distortionOf(camera)) {}

NormalisedPoint Lens::distort(const Eigen::Vector3d& ray) const {
  if (const auto* const wide = std::get_if<WideDistortion>(&distortion_)) return wide->distort(ray);
  const double depth = std::max(ray.z(), 1e-6);  // rays from beside or behind end at the rim
  return std::get<BrownDistortion>(distortion_).distort({ray.x() / depth, ray.y() / depth});
}

Eigen::Vector3d Lens::undistort(NormalisedPoint distorted) const {
  if (const auto* const wide = std::get_if<WideDistortion>(&distortion_)) return wide->undistort(distorted);
  const NormalisedPoint ideal = std::get<BrownDistortion>(distortion_).undistort(distorted);
  return {ideal.x, ideal.y, 1.0};
}

}  // namespace cartvo::calib
