#pragma once

#include <Eigen/Core>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// The virtual cameras of the rectified images: two equal, parallel pinhole cameras without distortion, the
/// right one at (baseline, 0, 0) in the left one's axes. Corresponding points are in the same row, and a
/// point at infinity has disparity zero.
struct Rectification {
  cv::Size size;              ///< of the rectified images, equal to that of the raw ones, px
  double focal_length = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< principal point, px
  double baseline = 0.0;      ///< m
  Eigen::Matrix3d R_rectified_left = Eigen::Matrix3d::Identity();   ///< left camera axes to rectified axes
  Eigen::Matrix3d R_rectified_right = Eigen::Matrix3d::Identity();  ///< right camera axes to rectified axes
  bool is_identity = false;  ///< the raw images are already rectified; then both rotations are exactly I
};

/// Rotations that make both cameras parallel, with their x axes along the baseline.
struct RectifyingRotations {
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity();   ///< left camera axes to rectified axes
  Eigen::Matrix3d right = Eigen::Matrix3d::Identity();  ///< right camera axes to rectified axes
};

/// Computes the rotations alone, without checking that the whole image can be rectified. Throws
/// std::invalid_argument if the right camera is not to the right of the left one.
RectifyingRotations rectifyingRotations(const Rig& rig);

/// Computes the rectification. Each camera is turned by half of the relative rotation, then both by the
/// smallest rotation that aligns the baseline with x (J.-Y. Bouguet, as in cv::stereoRectify). The image of a
/// wide lens is cut at 70 degrees from the rectified axis, since a plane cannot represent much more. The
/// square root is the only function of the C library used, so that every machine computes the same bits.
/// Throws std::invalid_argument with the reason if the rig cannot be rectified (cameras swapped, baseline not
/// horizontal, distortion that folds the image).
Rectification computeRectification(const Rig& rig, const RectificationSettings& settings);

}  // namespace cartvo::calib
