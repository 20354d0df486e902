#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/geometry/subset_random.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/stereo_camera.hpp"

// RANSAC search for the pose of the current pair.

namespace cartvo::vo {

constexpr double kWideGate = 2.0;  ///< factor on the gate for inaccurate poses

/// A landmark with a known depth that the current pair observes.
struct PosePoint {
  int anchor = 0;                                      ///< index into PoseProblem::anchors
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();  ///< in the anchor camera, z = 1
  double inverse_depth = 0.0;                          ///< 1/m
  double inverse_depth_stddev = 0.0;                   ///< 1/m
  Eigen::Vector2d left = Eigen::Vector2d::Zero();      ///< px, position in the current pair
  double weight = 1.0;                                 ///< Landmark::weight
  int level = 0;                                       ///< pyramid level, see Landmark
  /// px, stddev of each coordinate of `left` by the unknown motion from the exposure to that of its row.
  double row_noise = 0.0;
  bool still = false;    ///< whether it has kept its place in the left image
  bool inlier = false;   ///< result: within the gate of the pose found
  bool outlier = false;  ///< result: beyond the gate of inaccurate poses
};

/// Input of the pose search; the points' `inlier` and `outlier` are output.
struct PoseProblem {
  StereoCamera camera;
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> anchors;  ///< T_world_camera of the window's pairs
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();      ///< first guess of T_world_camera
  Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();   ///< centre of the motion gate
  std::vector<PosePoint> points;
  /// px, stddev of each coordinate of left positions for each pyramid level. The noise of the single patch is
  /// ignored: a gate that opens for blurred patches admits wrong matches (docs/architecture.md).
  std::array<double, kLandmarkLevels> noise{0.1, 0.1};
  /// px, of landmarks without a depth that have moved: no pose is measured by them.
  std::vector<Eigen::Vector2d> moved;
  /// Motion gate: largest difference from `expected` per component, m and rad. Unset without a prediction.
  std::optional<Vector6d> admissible_change;
};

/// Result of the pose search.
struct FoundPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;            ///< number of points
  double inlier_ratio = 0.0;  ///< weight of the inliers over the weight of all points
};

/// A pose beside the one found, and what tells them apart. Points that fit both tell nothing: far ones fit
/// any short motion, whether the near ones show the road, a vehicle or a part of the cart.
struct AlternativePose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  double weight = 0.0;           ///< of the points that fit this pose only
  double weight_of_found = 0.0;  ///< of the points that fit the pose found only
  double still_of_found = 0.0;   ///< of those among them that have kept their place in the image
};

/// Number of inliers that have kept their place in the image.
int countStillInliers(const PoseProblem& searched);

/// Whether most inliers have kept their place in the image, but less than half of the image agrees: a part of
/// the cart or dirt on the lens seems to stand at any motion, and fits a standstill exactly.
bool isFixedToImage(const PoseProblem& searched, const FoundPose& found);

/// Share of the weight from which a pose is unambiguous: the outliers have half of its weight at most. The
/// search ends with such a pose, and a pose beyond the motion gate must be one.
constexpr double kUnambiguousShare = 2.0 / 3.0;

/// Whether the inliers suffice to accept the pose.
inline bool hasEnoughInliers(const FoundPose& found, const ValiditySettings& validity) {
  return found.inliers >= validity.minimum_inliers && found.inlier_ratio >= validity.minimum_inlier_ratio;
}

/// Finds the current pose that the points fit best by RANSAC (M. Fischler, R. Bolles, 1981). Each subset of
/// four points gives a pose by a few Gauss-Newton steps on the reprojection error from the predicted pose
/// (A. Geiger et al., "StereoScan", 2011). The prediction and poses with more support than the earlier ones
/// are refined on their inliers, and the result is the one with the highest score (Search::scoreOf). Poses
/// outside the motion gate are rejected: a moving vehicle may fill most of the view, but the cart has
/// inertia.
class PoseFinder {
 public:
  PoseFinder();
  PoseFinder(PoseFinder&&) noexcept;
  PoseFinder& operator=(PoseFinder&&) noexcept;
  ~PoseFinder();

  /// Returns nothing with too few points or if no pose lies within the motion gate.
  std::optional<FoundPose> find(PoseProblem& problem, const PoseSearchSettings& settings,
                                SubsetRandom& random);

  /// Covariance of a perturbation on the right of the pose found, by its inliers: their errors scale the
  /// noise, so that a codec and wrong depths widen it. `searched`: as find() returned it.
  Matrix6d covarianceOf(const PoseProblem& searched, const FoundPose& found);

  /// Finds another pose, within the motion gate if there is one: the one that most outliers of the pose found
  /// agree on, with at least `minimum_inliers`. `searched`: as find() returned it.
  std::optional<AlternativePose> findAlternative(const PoseProblem& searched,
                                                 const PoseSearchSettings& settings, int minimum_inliers,
                                                 SubsetRandom& random);

 private:
  void setFlags(PoseProblem& problem, const Eigen::Isometry3d& T_world_camera, double gate);

  struct Work;
  std::unique_ptr<Work> work_;  // reused: keeps its memory from call to call
};

}  // namespace cartvo::vo
