#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/model/rig.hpp"

// Projection through a lens model, with derivatives by the point and by the camera parameters.

namespace cartvo::calib {

/// Number of camera parameters: fx fy cx cy and the eight coefficients of CameraModel::distortion.
inline constexpr int kCameraParameters = 12;
inline constexpr int kDistortion = 4;  ///< index of the first distortion coefficient
using CameraParameters = Eigen::Matrix<double, kCameraParameters, 1>;

CameraParameters parametersOf(const CameraModel& camera);
void setParameters(const CameraParameters& parameters, CameraModel& camera);

/// Projection of a point, with derivatives.
struct LensProjection {
  Eigen::Vector2d pixel;                                 ///< px
  Eigen::Matrix<double, 2, 3> J_point;                   ///< d(pixel)/d(point in camera axes), px/m
  Eigen::Matrix<double, 2, kCameraParameters> J_camera;  ///< d(pixel)/d(camera parameters)
};

/// Projects a point (camera axes, m) as Lens does, but continues the model beyond the radius where it folds,
/// so that a solver can pass through that region. std::nullopt where the model is undefined: Brown's at and
/// behind the camera's plane, the wide one on the negative optical axis.
std::optional<LensProjection> project(const CameraModel& camera, const Eigen::Vector3d& point);

}  // namespace cartvo::calib
