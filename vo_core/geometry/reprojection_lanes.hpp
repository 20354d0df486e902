#pragma once

#include <Eigen/Geometry>

#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/simd/double_lanes.hpp"

// SIMD version of reprojection.hpp for four landmarks of one anchor: the same definitions of projections and
// of perturbations (on the right).

namespace cartvo::vo {

/// Bearings and inverse depths of four landmarks in the anchor camera.
struct PlaceLanes {
  DoubleLanes bearing[3];
  DoubleLanes inverse_depth;
};

/// Rays R b + rho t, see projectLandmark().
struct RayLanes {
  DoubleLanes x, y, z;
};
template <typename Transform>  // T(row, column) is one value for all lanes or one of each
inline RayLanes rayOf(const Transform& T, const PlaceLanes& place) {
  const auto& [x, y, z] = place.bearing;
  const DoubleLanes& rho = place.inverse_depth;
  return {T(0, 0) * x + T(0, 1) * y + T(0, 2) * z + T(0, 3) * rho,
          T(1, 0) * x + T(1, 1) * y + T(1, 2) * z + T(1, 3) * rho,
          T(2, 0) * x + T(2, 1) * y + T(2, 2) * z + T(2, 3) * rho};
}

/// Normalised image coordinates of the landmarks. Those not in front of the camera have some finite value.
struct ViewLanes {
  DoubleLanes x, y;       ///< of the ray, at z = 1
  DoubleLanes inverse_z;  ///< of the ray before normalisation
};
inline ViewLanes viewOf(const RayLanes& ray) {
  DoubleLanes z = ray.z;
  clampToMinimum(kNearestRay, z);
  const DoubleLanes inverse_z = 1.0 / z;
  return {ray.x * inverse_z, ray.y * inverse_z, inverse_z};
}

/// Derivative of the view, at z = 1, by the inverse depth.
struct PixelLanes {
  DoubleLanes x, y;
};
template <typename Transform>
inline PixelLanes viewByInverseDepth(const Transform& T, const ViewLanes& view) {
  return {view.inverse_z * (T(0, 3) - view.x * T(2, 3)), view.inverse_z * (T(1, 3) - view.y * T(2, 3))};
}

/// Derivatives of the view's column and row (at z = 1) by the camera's pose.
inline PoseLanes columnByCamera(const ViewLanes& view, const PlaceLanes& place) {
  const DoubleLanes nearness = place.inverse_depth * view.inverse_z;
  return {{-nearness, DoubleLanes{}, nearness * view.x, view.x * view.y, -1.0 - view.x * view.x, view.y}};
}
inline PoseLanes rowByCamera(const ViewLanes& view, const PlaceLanes& place) {
  const DoubleLanes nearness = place.inverse_depth * view.inverse_z;
  return {{DoubleLanes{}, -nearness, nearness * view.y, 1.0 + view.y * view.y, -view.x * view.y, -view.x}};
}

}  // namespace cartvo::vo
