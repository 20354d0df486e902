// Distortion and its inverse for either lens model.
#include "calib/model/lens.hpp"

#include <algorithm>

namespace cartvo::calib {
namespace {

std::variant<BrownDistortion, WideDistortion> distortionOf(const CameraModel& camera) {
  if (camera.lens == LensModel::wide) return WideDistortion(camera);
  return BrownDistortion(camera);
}

}  // namespace

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
