// Difference of two calibrations of one rig, in projection and in depth.
#include "calib/solver/calibration_difference.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "calib/model/lens.hpp"
#include "calib/model/rotation.hpp"
#include "common/statistics.hpp"

namespace cartvo::calib {
namespace {

constexpr double kMinCosine = 0.5;  // of 60 degrees

Eigen::Vector2d pixelOf(const CameraModel& camera, const Lens& lens, const Eigen::Vector3d& ray) {
  const NormalisedPoint distorted = lens.distort(ray);
  return {camera.fx * distorted.x + camera.cx, camera.fy * distorted.y + camera.cy};
}

std::optional<Eigen::Vector3d> rayOf(const CameraModel& camera, const Lens& lens,
                                     const Eigen::Vector2d& pixel) {
  try {
    const Eigen::Vector3d ray =
        lens.undistort({(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy})
            .normalized();
    if (ray.z() >= kMinCosine) return ray;
  } catch (const std::invalid_argument&) {  // beyond the radius where the distortion folds
  }
  return std::nullopt;
}

/// The centres of a fine grid, in covered cells.
std::vector<Eigen::Vector2d> gridOf(cv::Size size, const ImageCoverage& coverage) {
  constexpr int kAcross = 24, kDown = 16;
  std::vector<Eigen::Vector2d> grid;
  for (int row = 0; row < kDown; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * size.width / kAcross - 0.5,
                                  (row + 0.5) * size.height / kDown - 0.5);
      if (coverage.covers(pixel, size)) grid.push_back(pixel);
    }
  }
  return grid;
}

/// The rotation that takes the rays of one calibration to those of the other.
Eigen::Matrix3d impliedRotation(const std::vector<Eigen::Vector3d>& from,
                                const std::vector<Eigen::Vector3d>& to) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    sum += to[i] * from[i].transpose();
  return bestRotation(sum);
}

void addProjectionDifferences(const CameraModel& a, const CameraModel& b, const ImageCoverage& coverage,
                              std::vector<double>& differences) {
  const Lens lens_a(a), lens_b(b);
  std::vector<Eigen::Vector3d> rays_a, rays_b;
  std::vector<Eigen::Vector2d> pixels;
  for (const Eigen::Vector2d& pixel : gridOf(a.size, coverage)) {
    const auto ray_a = rayOf(a, lens_a, pixel), ray_b = rayOf(b, lens_b, pixel);
    if (!ray_a || !ray_b) continue;
    rays_a.push_back(*ray_a);
    rays_b.push_back(*ray_b);
    pixels.push_back(pixel);
  }
  const Eigen::Matrix3d R_b_a = impliedRotation(rays_a, rays_b);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    differences.push_back((pixelOf(b, lens_b, R_b_a * rays_a[i]) - pixels[i]).norm());
}

/// The distance along the left ray of the point nearest to the right ray.
double triangulated(const Eigen::Vector3d& left_ray, const Eigen::Vector3d& right_ray, const Rig& rig) {
  const Eigen::Isometry3d T_left_right = rig.T_right_left.inverse();
  const Eigen::Vector3d d = T_left_right.linear() * right_ray, centre = T_left_right.translation();
  const double product = left_ray.dot(d);
  return (centre.dot(left_ray) - product * centre.dot(d)) / (1.0 - product * product);
}

/// Infinity without values: calibrations that cannot be compared do not count as equal.
double quantileOrInfinity(const std::vector<double>& values, double share) {
  return values.empty() ? std::numeric_limits<double>::infinity() : quantile(values, share);
}

DepthDifference depthDifference(const Rig& a, const Rig& b, const ImageCoverage& left,
                                const ImageCoverage& right, double distance) {
  const Lens left_a(a.left), right_a(a.right), left_b(b.left), right_b(b.right);
  std::vector<double> differences;
  for (const Eigen::Vector2d& pixel : gridOf(a.left.size, left)) {
    const auto ray_a = rayOf(a.left, left_a, pixel), ray_b = rayOf(b.left, left_b, pixel);
    if (!ray_a || !ray_b) continue;
    const double length = distance / ray_a->z();
    const Eigen::Vector2d in_right = pixelOf(a.right, right_a, a.T_right_left * (length * *ray_a));
    if (!right.covers(in_right, a.right.size)) continue;
    const auto right_ray = rayOf(b.right, right_b, in_right);
    if (!right_ray) continue;
    const double found = triangulated(*ray_b, *right_ray, b) * ray_b->z();
    // Diverging rays: the point is at infinity or beyond.
    differences.push_back(found > 0.0 ? std::abs(found - distance) : distance);
  }
  return {distance, quantileOrInfinity(differences, 0.5), quantileOrInfinity(differences, 0.95)};
}

}  // namespace

CalibrationDifference compareCalibrations(const Rig& a, const Rig& b, const ImageCoverage& left,
                                          const ImageCoverage& right, const std::vector<double>& distances) {
  std::vector<double> differences;
  addProjectionDifferences(a.left, b.left, left, differences);
  addProjectionDifferences(a.right, b.right, right, differences);
  CalibrationDifference result;
  double squares = 0.0;
  for (const double difference : differences)
    squares += difference * difference;
  result.projection_rms = differences.empty() ? std::numeric_limits<double>::infinity()
                                              : std::sqrt(squares / static_cast<double>(differences.size()));
  result.projection_p95 = quantileOrInfinity(differences, 0.95);
  result.baseline = std::abs(a.baseline() / b.baseline() - 1.0);
  for (const double distance : distances)
    result.depth.push_back(depthDifference(a, b, left, right, distance));
  return result;
}

}  // namespace cartvo::calib
