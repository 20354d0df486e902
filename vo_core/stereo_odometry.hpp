#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>

#include <opencv2/core/mat.hpp>

#include "vo_core/odometry_settings.hpp"

namespace cartvo {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A rectified stereo camera: both images share focal length and principal point, rows correspond.
struct StereoCamera {
  double focal_length = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< principal point, px
  double baseline = 0.0;      ///< m
  int width = 0, height = 0;  ///< px
};

/// A rectified pair of images, CV_8UC1 of the camera's size, and the instants of their exposure.
struct StereoImages {
  cv::Mat left;
  cv::Mat right;
  std::int64_t left_exposure_ns = 0;
  std::int64_t right_exposure_ns = 0;
};

/// Why an estimate is not there, as bits.
enum class OdometryReason : std::uint32_t {
  none = 0,
  first_pair = 1u << 0,        ///< nothing to compare with yet
  too_few_features = 1u << 1,  ///< the images hold too little texture
  too_few_matches = 1u << 2,   ///< too few features tracked in time and matched in stereo
  too_few_inliers = 1u << 3,   ///< no motion explains enough of the matches
  high_residual = 1u << 4,     ///< the best motion explains the matches badly
  time_step = 1u << 5,         ///< time stood still, ran backwards or jumped
};
constexpr OdometryReason operator|(OdometryReason a, OdometryReason b) {
  return static_cast<OdometryReason>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}

struct FeatureCounts {
  int detected = 0;  ///< features alive after detection, left image
  int tracked = 0;   ///< found again from the previous left image
  int matched = 0;   ///< of the tracked, with a disparity now and before
  int inliers = 0;   ///< of the matched, explained by the motion
};

/// What one pair told about the motion. Transforms are of the rectified left camera (x right, y down, z
/// forward). Covariances: order (x, y, z, rotation about x, y, z), m and rad, as a perturbation on the right:
/// in the axes of the current camera.
struct OdometryEstimate {
  std::int64_t exposure_ns = 0;  ///< of the left image
  bool valid = false;            ///< whether the motion was measured
  OdometryReason reasons = OdometryReason::none;
  std::uint32_t reset_counter = 0;  ///< counts the epochs: grows when the pose starts anew after a loss
  double time_step = 0.0;           ///< s since the previous pair, left to left
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();  ///< motion; identity if not valid
  Matrix6d motion_covariance = Matrix6d::Zero();
  Eigen::Isometry3d T_world_camera =
      Eigen::Isometry3d::Identity();  ///< pose; world: the camera at the first pair
  Matrix6d pose_covariance = Matrix6d::Zero();
  FeatureCounts counts;
};

/// The stages of one pair, in the order of the thesis' Table 5-2 where they occur there.
enum class Stage : std::uint8_t {
  rectify,
  pyramid,
  optical_flow,
  disparity,
  reproject,
  motion,
  detect,
  weights,
  minimum_distance
};
constexpr int kStageCount = 9;
const char* stageName(Stage stage);

/// Is told when a stage begins and ends; whoever owns a clock measures. vo_core itself has none.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void begin(Stage stage) = 0;
  virtual void end(Stage stage) = 0;
};

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
  /// show.
  OdometryEstimate process(const StereoImages& images, StageObserver& observer);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
