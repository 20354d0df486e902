#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"

// Bundle adjustment over the window of pairs.

namespace cartvo::vo {

/// Measured position of a landmark in one pair, see Observation.
struct BundleObservation {
  int pose = 0;  ///< index into the problem's poses
  bool stereo = false;
  Eigen::Vector2d left = Eigen::Vector2d::Zero();   ///< px
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< px, at the right camera's own exposure time

  Eigen::Vector2d relative_noise = Eigen::Vector2d::Ones();  ///< stddev of `left` over BundleNoise::pixel

  double disparity() const { return left.x() - right.x(); }
};

/// Landmark of a bundle problem: a ray of its anchor camera and an inverse depth along z.
struct BundleLandmark {
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();  ///< in the anchor camera, z = 1
  double inverse_depth = 0.0;                          ///< 1/m; initial value, then result
  double information = 0.0;                            ///< m^2; result, of inverse_depth with the poses fixed
  double prior_inverse_depth = 0.0;
  double prior_information = 0.0;
  double prior_dinverse_depth_doffset = 0.0;  ///< 1/(m s), see Landmark
  double dinverse_depth_doffset = 0.0;        ///< 1/(m s); result, see Landmark
  double weight = 1.0;
  int level = 0;  ///< pyramid level, see Landmark
  FixedVector<BundleObservation, kMaximumWindowPairs>
      observations;    ///< anchor first: its `left` defines the bearing
  double error = 0.0;  ///< result: RMS of the last observation's normalised residuals
};

/// Measurement noise of the patches of one pyramid level, stddev in px of the full image.
struct BundleNoise {
  double pixel = 0.15;      ///< each coordinate of a left position, for a typical patch
  double disparity = 0.15;  ///< disparity at infinity
  double stretch = 0.006;   ///< px of disparity noise per px of disparity: near patches deform more
};

using BundleNoises = std::array<BundleNoise, kLandmarkLevels>;

/// Input and output of the bundle adjustment.
struct BundleProblem {
  StereoCamera camera;
  /// Initial values, then results. `dpose_doffset` is an input for fixed poses and a result for free ones.
  TimedPoses poses;
  int fixed = 1;  ///< number of fixed poses, the oldest ones
  /// Factor on the weight of left positions in fixed pairs; below 1 because these poses have errors.
  double fixed_pose_weight = 1.0;
  /// Information matrix of the prior that ties pose i to its initial value; perturbations on the right. At
  /// most one for each pose. Ignored for fixed poses; poses beyond the end of the list have no prior.
  FixedVector<Matrix6d, kMaximumWindowPairs> pose_prior_information;
  double scale_stddev = UncertaintySettings().scale_stddev;  ///< prior of the window's scale factor
  std::vector<BundleLandmark> landmarks;
  BundleNoises noise;
};

/// Unknowns of the free poses: six each, oldest first. The matrices need no heap memory.
constexpr int kMaximumPoseUnknowns = 6 * kMaximumWindowPairs;
using PoseMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaximumPoseUnknowns, kMaximumPoseUnknowns>;
using PoseVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaximumPoseUnknowns, 1>;

/// Ratio of the residuals, by their median, to the assumed noise.
struct NoiseScale {
  double pixel = 1.0;      ///< left positions
  double disparity = 1.0;  ///< disparities
};

/// Result of an adjustment besides the poses and depths.
struct BundleResult {
  bool converged = false;
  /// Covariance of all free poses relative to the fixed ones; perturbations on the right, six each, oldest
  /// first.
  PoseMatrix covariance;
  std::array<NoiseScale, kLandmarkLevels> noise_scale;
  /// Variance of the window's scale factor from its disparities, at most that of an unobserved scale
  /// (BundleProblem::scale_stddev).
  double scale_variance = 0.0;
  /// Normal equations of the remaining error of the rig calibration: information, and information times
  /// change. The window's scale is marginalised, because it was estimated under the same error.
  RigCorrection::Matrix rig_information = RigCorrection::Matrix::Zero();
  RigCorrection::Vector rig_gradient = RigCorrection::Vector::Zero();
};

/// Minimises the reprojection error in both images, each at its own exposure time, over the free poses and
/// all inverse depths: Gauss-Newton with Cauchy weights; the Schur complement eliminates the depths
/// (B. Triggs et al., "Bundle adjustment - a modern synthesis", 2000). Residuals of an observation: the left
/// position minus the projection (except in the anchor, which defines the bearing) and the disparity minus
/// that of the projections. Residuals of a pose with a prior: its initial value minus the pose.
class BundleAdjuster {
 public:
  BundleAdjuster();
  BundleAdjuster(BundleAdjuster&&) noexcept;
  BundleAdjuster& operator=(BundleAdjuster&&) noexcept;
  ~BundleAdjuster();

  /// Solves `problem` in place. The result has `converged` false if the problem is degenerate.
  BundleResult adjust(BundleProblem& problem, const BundleSettings& settings);

 private:
  struct Work;
  std::unique_ptr<Work> work_;  // reused: keeps its memory from call to call
};

}  // namespace cartvo::vo
