// Geometry of a rectified stereo pair: triangulation, projection and the covariance of points.
#include "vo_core/stereo_camera.hpp"

#include <cmath>
#include <stdexcept>

#include "common/exact_text.hpp"

namespace cartvo::vo {
namespace {

void require(bool sensible, const char* name, double value, const char* expected) {
  if (sensible) return;
  throw std::invalid_argument(std::string("stereo camera: ") + name + " is " + roundedText(value) +
                              ": expected " + expected);
}

}  // namespace

void validate(const StereoCamera& camera) {
  require(std::isfinite(camera.focal_length) && camera.focal_length > 0.0, "focal_length",
          camera.focal_length, "more than 0 px");
  require(std::isfinite(camera.baseline) && camera.baseline > 0.0, "baseline", camera.baseline,
          "more than 0 m");
  require(std::isfinite(camera.cx), "cx", camera.cx, "a number of pixels");
  require(std::isfinite(camera.cy), "cy", camera.cy, "a number of pixels");
  require(camera.width >= 64 && camera.width <= 8192, "width", camera.width, "64 to 8192 px");
  require(camera.height >= 64 && camera.height <= 8192, "height", camera.height, "64 to 8192 px");
}

Eigen::Vector3d triangulate(const StereoCamera& camera, const StereoMeasurement& measurement) {
  const double z = camera.focal_length * camera.baseline / measurement.disparity;
  return {(measurement.left.x() - camera.cx) * z / camera.focal_length,
          (measurement.left.y() - camera.cy) * z / camera.focal_length, z};
}

Eigen::Vector2d project(const StereoCamera& camera, const Eigen::Vector3d& point) {
  return {camera.cx + camera.focal_length * point.x() / point.z(),
          camera.cy + camera.focal_length * point.y() / point.z()};
}

Eigen::Matrix3d pointCovariance(const StereoCamera& camera, const Eigen::Vector3d& point, double pixel_noise,
                                double disparity_noise) {
  const double across = point.z() / camera.focal_length * pixel_noise;
  // dP/dd = -P / d: an error of the disparity moves the point along its ray.
  const double disparity = camera.focal_length * camera.baseline / point.z();
  const Eigen::Vector3d along = point * (disparity_noise / disparity);
  Eigen::Matrix3d covariance = along * along.transpose();
  covariance(0, 0) += across * across;
  covariance(1, 1) += across * across;
  return covariance;
}

}  // namespace cartvo::vo
