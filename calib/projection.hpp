#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/rig.hpp"

namespace cartvo {

/// fx fy cx cy and the eight coefficients of CameraModel::distortion.
inline constexpr int kCameraParameters = 12;
inline constexpr int kDistortion = 4;  ///< where the coefficients begin
using CameraParameters = Eigen::Matrix<double, kCameraParameters, 1>;

CameraParameters parametersOf(const CameraModel& camera);
void setParameters(const CameraParameters& parameters, CameraModel& camera);

/// Where a camera sees a point, and how that changes.
struct LensProjection {
  Eigen::Vector2d pixel;                                 ///< px
  Eigen::Matrix<double, 2, 3> J_point;                   ///< by the point in camera axes, px/m
  Eigen::Matrix<double, 2, kCameraParameters> J_camera;  ///< by the camera's parameters
};

/// The projection of a point (camera axes, m), as Lens has it but with the model continued beyond where it
/// folds, so that a solver passing through there finds its way back. Nothing where the model has no value:
/// for Brown's at and behind the camera's plane, for the wide one at and behind the camera's axis turned
/// round.
std::optional<LensProjection> project(const CameraModel& camera, const Eigen::Vector3d& point);

}  // namespace cartvo
