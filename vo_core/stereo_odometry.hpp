#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "vo_core/key_frames.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rig_check.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/stage_observer.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// A rectified pair of images, CV_8UC1 of the camera's size, and the instants of their exposure.
struct StereoImages {
  cv::Mat left;
  cv::Mat right;
  std::int64_t left_exposure_ns = 0;
  std::int64_t right_exposure_ns = 0;
  double offset_deviation = 0.0;  ///< s, standard deviation of right minus left exposure
  KeyFrames key_frames{};
};

/// Why an estimate is not there.
enum class OdometryReason : std::uint8_t {
  none,
  first_pair,           ///< nothing to compare with yet
  too_few_features,     ///< the images hold too little texture
  too_few_matches,      ///< too few features tracked in time and matched in stereo
  too_few_inliers,      ///< no motion explains enough of the matches, or at first clearly the most
  high_residual,        ///< the best motion explains the matches badly
  time_step,            ///< time stood still, ran backwards or jumped
  implausible_motion,   ///< faster than the settings say a cart can be
  degenerate_geometry,  ///< the matches leave a direction of the motion open
  zero_velocity,        ///< of a valid estimate: the cart stands, and its pose is held
  offset_uncertain,     ///< how far apart the exposures are is not known well enough
  repeated_picture,     ///< a camera shows once more what it showed before, and the cart moved
};
constexpr int kOdometryReasonCount = 12;

/// The reasons of one estimate. Only `estimator: thesis` gives more than one at a time.
class OdometryReasons {
 public:
  constexpr OdometryReasons() = default;
  constexpr OdometryReasons(OdometryReason reason) { add(reason); }  // NOLINT(google-explicit-constructor)

  constexpr void add(OdometryReason reason) {
    if (reason != OdometryReason::none) set_ |= bitOf(reason);
  }
  constexpr bool has(OdometryReason reason) const { return (set_ & bitOf(reason)) != 0; }
  constexpr bool operator==(const OdometryReasons&) const = default;

 private:
  static constexpr std::uint32_t bitOf(OdometryReason reason) { return 1U << static_cast<unsigned>(reason); }

  std::uint32_t set_ = 0;
};

struct FeatureCounts {
  int detected = 0;  ///< features alive after detection, left image
  int tracked = 0;   ///< found again from the previous left image
  int matched = 0;   ///< of the tracked, with a disparity now and before
  int inliers = 0;   ///< of the matched, explained by the motion
  int stereo = 0;    ///< of the detected, found in this pair's right image; not looked for during a stand
};

/// What one pair told about the motion. The motion is the one since the reference: the last pair whose pose
/// is known, which is the pair before unless that one was invalid.
///
/// After an invalid pair the lost features are looked for again for `tracking.search_again` pairs; if that
/// succeeds, the pose goes on without a gap and `time_step` and motion span the gap. Otherwise the pose is
/// lost: the next measured motion begins a new epoch, `reset_counter` grows by one, and the pose starts anew
/// from identity at the pair before. A time step out of range begins a new epoch at that pair. Within an
/// epoch the pose never jumps: each pose is the reference's times the motion, but for what a pair has told of
/// the reference since that was published.
///
/// Transforms are of the rectified left camera (x right, y down, z
/// forward). Covariances: order (x, y, z, rotation about x, y, z), m and rad, as a perturbation on the right:
/// in the axes of the current camera.
struct OdometryEstimate {
  std::int64_t exposure_ns = 0;  ///< of the left image
  bool valid = false;            ///< whether the motion was measured
  OdometryReasons reasons;
  std::uint32_t reset_counter = 0;  ///< counts the epochs: grows when the pose starts anew after a loss
  double time_step = 0.0;           ///< s since the reference, left to left; 0 without
  /// Motion since the reference, as it is known to have been then (`estimator: thesis`: as it was published);
  /// identity if not valid.
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  Matrix6d motion_covariance = Matrix6d::Zero();
  /// The motion's error if the pair's offset is off by its standard deviation; its outer product is part of
  /// motion_covariance. Neighbouring motions err together.
  Vector6d motion_offset_error = Vector6d::Zero();
  Eigen::Isometry3d T_world_camera =
      Eigen::Isometry3d::Identity();  ///< pose; world: the camera where the epoch began
  Matrix6d pose_covariance = Matrix6d::Zero();
  FeatureCounts counts;
  std::optional<RigCheck> rig;  ///< nothing where it is not watched
};

class OdometryMethod;
class RepeatedPictures;

/// Stereo visual odometry. Pure: the same images in the same order give the same estimates, whatever the
/// number of threads. Not thread-safe.
class StereoOdometry {
 public:
  /// Throws std::invalid_argument if the camera or the settings make no sense, naming the value.
  StereoOdometry(const StereoCamera& camera, const OdometrySettings& settings);
  ~StereoOdometry();
  StereoOdometry(StereoOdometry&&) noexcept;
  StereoOdometry& operator=(StereoOdometry&&) noexcept;

  /// Takes the next pair and says how the camera moved since the one before. Never throws on what the images
  /// show; throws std::invalid_argument if they are not CV_8UC1 of the camera's size. Keeps no reference to
  /// the images but to those that were placed (placeNext).
  OdometryEstimate process(const StereoImages& images, StageObserver& observer);

  /// Lets `images.left` and `.right` show where the next pair's images may be written, of the camera's size
  /// (CV_8UC1): process() of them copies nothing. Valid until that; what is not written there is copied, and
  /// left as it is by methods that have no place to give.
  void placeNext(StereoImages& images);

  /// From the next pair on, aims at so many features in each left image (OdometrySettings::features), so that
  /// a caller who is short of time can have fewer. Throws std::invalid_argument if out of its range.
  void aimAt(int features);

 private:
  StereoCamera camera_;
  OdometrySettings settings_;
  std::unique_ptr<OdometryMethod> method_;
  std::unique_ptr<RepeatedPictures> repeated_;
  OdometryEstimate last_;  ///< of the last pair
};

}  // namespace cartvo
