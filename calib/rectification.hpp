#pragma once

#include <Eigen/Core>

#include <opencv2/core/types.hpp>

#include "calib/rig.hpp"

namespace cartvo {

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

/// The rotations that make two cameras parallel, their rows along the baseline.
struct RectifyingRotations {
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity();   ///< left camera axes to rectified axes
  Eigen::Matrix3d right = Eigen::Matrix3d::Identity();  ///< right camera axes to rectified axes
};

/// The rotations alone, which do not ask whether the whole image can be rectified. Throws
/// std::invalid_argument if the right camera does not stand to the right of the left one.
RectifyingRotations rectifyingRotations(const Rig& rig);

/// Computes the rectification. Half of the relative rotation goes to each camera, then the least rotation
/// that lays the baseline along x (J.-Y. Bouguet, as in cv::stereoRectify). Of a wide lens' image no more is
/// kept than what lies within 70 degrees of the rectified axis: a plane cannot hold much more. Uses no
/// function of the mathematical library but the square root, so that each machine computes the same bits.
/// Throws std::invalid_argument if the rig cannot be rectified, saying why (cameras swapped, baseline not
/// horizontal, distortion that folds the image).
Rectification computeRectification(const Rig& rig, const RectificationSettings& settings);

}  // namespace cartvo
