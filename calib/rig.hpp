#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// A pinhole camera with Brown's distortion (thesis 4.5-4.7; D. C. Brown, "Close-range camera calibration",
/// 1971) in OpenCV's order and sign.
struct CameraModel {
  cv::Size size;                                  ///< of the images this model holds for, px
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px; pixel centres at integer coordinates
  std::array<double, 8> distortion{};             ///< k1 k2 p1 p2 k3 k4 k5 k6; zeros: none
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

  /// Distance of the two cameras, m.
  double baseline() const { return T_right_left.translation().norm(); }
};

/// Camera axes (x right, y down, z forward) seen in body axes (x forward, y left, z up), origin in the
/// camera: the mount of a rig that does not say where on the cart it sits.
Eigen::Isometry3d forwardLookingMount();

}  // namespace cartvo
