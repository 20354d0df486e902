#pragma once

#include <Eigen/Core>

#include <opencv2/core/types.hpp>

#include "calib/rig.hpp"

namespace cartvo {

struct RectificationSettings {
  /// How much of the raw images is kept, as cv::stereoRectify's alpha: 0 crops until no pixel lacks a source,
  /// 1 shrinks until no raw pixel is lost.
  double free_scaling = 0.0;
};

/// What rectified images are images of: two equal pinhole cameras without distortion, parallel, the right one
/// at (baseline, 0, 0) in the left one's axes, so that a point at infinity has disparity zero and rows
/// correspond.
struct Rectification {
  cv::Size size;              ///< of the rectified images: that of the raw ones, px
  double focal_length = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< principal point, px
  double baseline = 0.0;      ///< m
  Eigen::Matrix3d R_rectified_left = Eigen::Matrix3d::Identity();   ///< left camera axes to rectified axes
  Eigen::Matrix3d R_rectified_right = Eigen::Matrix3d::Identity();  ///< right camera axes to rectified axes
  bool is_identity = false;  ///< the raw images are rectified already; then both rotations are exactly I
};

/// Computes the rectification. Half of the relative rotation goes to each camera, then the least rotation
/// that lays the baseline along x (J.-Y. Bouguet, as in cv::stereoRectify). Uses no transcendental function,
/// so that each machine computes the same bits. Throws std::invalid_argument if the rig cannot be rectified,
/// saying why (cameras swapped, baseline not horizontal, distortion that folds the image).
Rectification computeRectification(const Rig& rig, const RectificationSettings& settings);

}  // namespace cartvo
