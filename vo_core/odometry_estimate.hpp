#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "vo_core/image_region.hpp"
#include "vo_core/key_frames.hpp"
#include "vo_core/odometry_reason.hpp"
#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/shutter.hpp"

// Input and output of StereoOdometry: images in, motion and pose with covariances out.

namespace cartvo::vo {

/// A rectified image pair and its exposure instants.
struct StereoImages {
  cv::Mat left;   ///< CV_8UC1, size of the camera
  cv::Mat right;  ///< CV_8UC1, size of the camera
  /// Instants of exposure, ns. Any epoch, the same for both cameras and for all pairs.
  std::int64_t left_exposure_ns = 0;
  std::int64_t right_exposure_ns = 0;
  double offset_stddev = 0.0;  ///< s, standard deviation of the right exposure minus the left
  KeyFrames key_frames{};      ///< which images are key frames of a video; none by default
  /// pictureDigest() of the images as received, before rectification; 0: that of `left` and `right`.
  std::uint64_t left_digest = 0, right_digest = 0;
};

/// How far the images can be trusted after a pair. Only the estimates of `tracking` and `standstill` are
/// valid. IntegrityMonitor has the transitions.
enum class IntegrityState : std::uint8_t {
  tracking,
  standstill,    ///< zero-velocity updates hold the pose
  left_frozen,   ///< the left camera repeats its image while the cart moves
  right_frozen,  ///< the right one does
  both_frozen,   ///< both do
  lost,          ///< no motion is known: before the first one, and while tracking fails
};

/// Numbers of features of a pair.
struct FeatureCounts {
  int detected = 0;  ///< in the left image, after detection
  int tracked = 0;   ///< found again from the previous left image
  int matched = 0;   ///< of the tracked, with a depth
  int inliers = 0;   ///< of the matched, consistent with the motion
  int stereo = 0;    ///< of the detected, found in the right image; not counted during a standstill
};

/// Velocity and acceleration at the instant of an exposure, in the camera's axes. The acceleration is that of
/// the camera's origin, and of its rate.
struct ExposureTwist {
  Vector6d value = Vector6d::Zero();  ///< m/s and rad/s
  Matrix6d covariance = Matrix6d::Zero();
  Vector6d acceleration = Vector6d::Zero();  ///< m/s^2 and rad/s^2
  Matrix6d acceleration_covariance = Matrix6d::Zero();
};

/// Result for one pair.
///
/// Frames: the rectified left camera, x right, y down, z forward. The world is the camera at the start of the
/// epoch. T_a_b maps coordinates in b to coordinates in a.
///
/// Covariances: order (x, y, z, rotation about x, y, z), m and rad, of a perturbation on the right:
/// T_true = T * motionFromVector(perturbation), in the axes of the current camera.
///
/// Reference: the motion is relative to the last pair with a valid pose, which is the previous pair unless
/// that one was invalid. Lost features are searched for over `tracking.search_again` pairs, and ambiguous
/// ones for maximum_time_step. If found, the pose continues, and time_step and motion span the gap. Otherwise
/// the next valid motion starts a new epoch: reset_counter increments, and the pose restarts from the
/// identity at the pair before that motion. An epoch without a valid motion does not end.
///
/// Within an epoch the pose has no jumps: T_world_camera = reference pose * T_previous_current, up to what a
/// pair corrects of its reference, which has already been published.
struct OdometryEstimate {
  std::int64_t exposure_ns = 0;  ///< of the left image
  bool valid = false;            ///< whether a motion was measured
  OdometryReasons reasons;       ///< empty if valid, except for zero_velocity
  IntegrityState state = IntegrityState::lost;
  std::uint32_t reset_counter = 0;  ///< number of the epoch, from 0
  double time_step = 0.0;           ///< s from the reference, left exposure to left exposure; 0 if invalid
  /// Motion since the reference, whose pose is as estimated now (`estimator: thesis`: as published); identity
  /// if invalid.
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  Matrix6d motion_covariance = Matrix6d::Zero();
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  Matrix6d pose_covariance = Matrix6d::Zero();  ///< relative to the start of the epoch
  FeatureCounts counts;
  std::optional<RigCalibrationError> rig;  ///< empty if it is not estimated
  /// At the left exposure; empty if it is not valid, or if the velocity is not known better than by the
  /// motion divided by the time step.
  std::optional<ExposureTwist> twist;
  std::optional<ReadoutEstimates> readouts;  ///< empty if they are not estimated
  /// Parts of the image that do not move with the scene and are left out: lettering, dirt, the cart itself.
  ImageRegions still_regions;
  /// Of an invalid pair: what stands in the left image agrees with a standstill, while the rest of it moves.
  bool part_stands = false;
  /// Fault of the pair's geometry; none unless the reasons have wrong_stereo_geometry.
  StereoFault stereo_fault = StereoFault::none;
};

}  // namespace cartvo::vo
