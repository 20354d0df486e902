#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "vo_core/held_poses.hpp"
#include "vo_core/reduced_system.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// How the result errs if all right cameras were exposed later than their offsets say. With the state x, the
/// unmodelled delay d, the residuals z - h(x, d) and the poses that stand wrong by P d already (H: the
/// Hessian),
///
///   dx = H^-1 (J^T W (dh/dd - J_standing P) + L P_held) d,
///
/// the last by poses that are held, by an information L, where they stood:
///
/// the consideration of a parameter that is not estimated (S. Schmidt, "Application of state-space methods to
/// navigation problems", 1966).
class LateRight {
 public:
  void reset(const BundleProblem& problem, const BundleCameras& cameras, const BundleBlocks& blocks);

  // Visits of ReducedSystem::build().
  void begin(const LandmarkBlock& block) { by_depth_ = block.prior_information * block.prior_by_late_right; }

  void add(const BlockView& view, const SightingRows& rows) {
    const Change& change = changes_[view.sighting.pose * count_ + view.host];
    const PixelLanes left = viewByRay(view.left, rayOf(change.left, view.place));
    const PixelLanes right = viewByRay(view.right, rayOf(change.right, view.place));
    const SightingBlock& sighting = view.sighting;
    const DoubleLanes by_delay[SightingRows::kCount] = {
        focal_length_ * sighting.position_precision[0] * left.x,
        focal_length_ * sighting.position_precision[1] * left.y,
        focal_length_ * sighting.disparity_precision * (left.x - right.x)};
#pragma GCC unroll 1
    for (int i = view.isHost() ? SightingRows::kDisparity : 0; i < SightingRows::kCount; ++i)
      add(rows.row[i], by_delay[i]);
  }

  void eliminate(const DepthBlock& depth, const PoseLanes* by_poses) {
    const DoubleLanes weighted = depth.variance * by_depth_;
    for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
#pragma GCC unroll 1
      for (int axis = 0; axis < 6; ++axis)
        by_poses_[pose].value[axis] -= weighted * by_poses[pose].value[axis];
    by_depths_.push_back({by_depth_});
  }

  /// Writes `by_late_right` of the free poses and of the landmarks.
  void conclude(const Eigen::LDLT<PoseMatrix>& factor, const ReducedSystem& system, const HeldPoses& held,
                const BundleBlocks& blocks, BundleProblem& problem) const;

 private:
  struct Change {
    BundleCameras::Change left, right;
  };
  struct DepthLanes {
    DoubleLanes value;
  };

  void add(const RowLanes& row, const DoubleLanes& by_delay) {
    const DoubleLanes weighted = row.weight * by_delay;
    by_depth_ += weighted * row.by_inverse_depth;
#pragma GCC unroll 1
    for (int a = 0; a < row.poses; ++a)
#pragma GCC unroll 1
      for (int axis = 0; axis < 6; ++axis)
        by_poses_[row.pose[a]].value[axis] += weighted * row.by_pose[a].value[axis];
  }

  int count_ = 0;
  double focal_length_ = 0.0;
  std::vector<Change> changes_;  // of each camera, seen from each host
  PoseSums by_poses_;
  DoubleLanes by_depth_{};  // of the present block
  std::vector<DepthLanes> by_depths_;
};

}  // namespace cartvo
