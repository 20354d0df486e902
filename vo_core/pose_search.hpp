#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/subset_random.hpp"

namespace cartvo {

/// A landmark whose place is known, seen by the current pair.
struct PosePoint {
  int host = 0;                                        ///< index into the hosts
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();  ///< in the host, z = 1
  double inverse_depth = 0.0;                          ///< 1/m
  double inverse_depth_deviation = 0.0;                ///< 1/m, standard deviation
  Eigen::Vector2d left = Eigen::Vector2d::Zero();      ///< px, where the current pair sees it
  double weight = 1.0;                                 ///< trust
  int level = 0;                                       ///< as Landmark's
  bool inlier = false;                                 ///< result: explained by the pose that was found
};

struct PoseProblem {
  StereoCamera camera;
  FixedVector<Eigen::Isometry3d, kMostWindowPairs> hosts;   ///< T_world_camera of the known pairs
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  ///< T_world_camera of the current one, expected
  std::vector<PosePoint> points;
  /// Of left positions, in each coordinate, level by level; no other part of it is used. Whatever their
  /// patches: a gate that opens for what is vague lets in what is wrong (docs/experiments.md).
  BundleNoises noise;
  /// How far the motion may lie from the prediction, or nothing if there is none.
  std::optional<Vector6d> admissible_change;  ///< m and rad, per component
};

struct FoundPose {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;      ///< points
  double weight = 0.0;  ///< of the points that are explained
  double share = 0.0;   ///< of the points' weight that is explained
};

/// Whether so many points agree on a pose that it is believed.
inline bool enoughAgree(const FoundPose& found, const ValiditySettings& validity) {
  return found.inliers >= validity.minimum_inliers && found.share >= validity.minimum_inlier_ratio;
}

/// The current pose that explains most of the points' weight. RANSAC (M. Fischler, R. Bolles, 1981) over
/// subsets of four points, each of which gives a pose by a few Gauss-Newton steps on the reprojection error
/// that begin at the start (A. Geiger et al., "StereoScan", 2011); the best one, and the start itself, are
/// polished on all they explain. Poses that change the motion more than is admissible do not compete: what
/// moves by itself may fill most of the view, but the cart has inertia.
class PoseFinder {
 public:
  PoseFinder();
  PoseFinder(PoseFinder&&) noexcept;
  PoseFinder& operator=(PoseFinder&&) noexcept;
  ~PoseFinder();

  std::optional<FoundPose> find(PoseProblem& problem, const PoseSearchSettings& settings,
                                SubsetRandom& random);

 private:
  struct Work;
  std::unique_ptr<Work> work_;  // kept from problem to problem for its memory
};

}  // namespace cartvo
