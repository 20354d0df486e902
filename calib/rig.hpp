#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// How a lens bends the rays that come to it; see BrownDistortion and WideDistortion.
enum class LensModel : std::uint8_t {
  brown,  ///< a pinhole with Brown's distortion (thesis 4.5-4.7): k1 k2 p1 p2 k3 k4 k5 k6, as in OpenCV
  wide,   ///< Kannala and Brandt's fisheye: k1 k2 k3 k4, then zeros, as in OpenCV's fisheye module
};

/// A camera: its lens and where its sensor stands behind it.
struct CameraModel {
  cv::Size size;                                  ///< of the images this model holds for, px
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px; pixel centres at integer coordinates
  LensModel lens = LensModel::brown;
  std::array<double, 8> distortion{};  ///< the lens model's coefficients
};

/// How many coefficients a lens model has: the first ones of CameraModel::distortion.
std::size_t distortionCount(LensModel lens);

/// Whether the camera's images are those of a pinhole, without distortion.
bool isPinhole(const CameraModel& camera);

/// How rectified images are cut out of the raw ones.
struct RectificationSettings {
  /// How much of the raw images is kept, as cv::stereoRectify's alpha: 0 crops until no pixel lacks a source,
  /// 1 shrinks until no raw pixel is lost.
  double free_scaling = 0.0;
};

/// The two cameras, how they stand to each other, and how they sit on the cart.
struct Rig {
  std::string name;
  CameraModel left;
  CameraModel right;
  Eigen::Isometry3d T_right_left =
      Eigen::Isometry3d::Identity();  ///< left camera axes to right camera axes, m
  Eigen::Isometry3d T_body_camera =
      Eigen::Isometry3d::Identity();  ///< left camera axes to body axes (REP-103), m
  RectificationSettings rectification;
  /// Standard deviation of the scale, as a share: how much all lengths that the rig measures may be too long
  /// or too short together, as its baseline is. 0: not said, which counts as
  /// exact.
  double scale_deviation = 0.0;

  /// Distance of the two cameras, m.
  double baseline() const { return T_right_left.translation().norm(); }
};

/// Camera axes (x right, y down, z forward) seen in body axes (x forward, y left, z up), origin in the
/// camera: the mount of a rig that does not say where on the cart it sits.
Eigen::Isometry3d forwardLookingMount();

}  // namespace cartvo
