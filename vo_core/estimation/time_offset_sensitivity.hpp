#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "vo_core/estimation/pose_priors.hpp"
#include "vo_core/estimation/reduced_system.hpp"

// Sensitivity of an adjusted bundle problem to the time offset. Internal to the bundle adjustment.

namespace cartvo::vo {

/// Sensitivity of poses and depths to the time offset: their errors for each second by which all right
/// cameras were exposed later than assumed. With the state x, the error d of the offset, the residuals z -
/// h(x, d), their weights W, the Hessian H, the errors P d of fixed poses and the information L of the pose
/// priors,
///
///   dx = H^-1 (J^T W (dh/dd - J_fixed P) + L P_prior) d.
///
/// The offset is a considered, not an estimated parameter (S. Schmidt, "Application of state-space methods to
/// navigation problems", 1966).
class TimeOffsetSensitivity {
 public:
  void reset(const BundleProblem& problem, const BundleCameras& cameras, const BundleBlocks& blocks);

  // Callbacks of ReducedSystem::build().
  void begin(const LandmarkBlock& block) {
    by_depth_ = block.prior_information * block.prior_dinverse_depth_doffset;
  }

  void add(const BlockView& view, const ObservationRows& rows) {
    const Change& change = changes_[view.observation.pose * count_ + view.anchor];
    const PixelLanes left = viewByRay(view.left, rayOf(change.left, view.place));
    const PixelLanes right = viewByRay(view.right, rayOf(change.right, view.place));
    const ObservationBlock& observation = view.observation;
    const DoubleLanes by_offset[ObservationRows::kCount] = {
        focal_length_ * observation.position_precision[0] * left.x,
        focal_length_ * observation.position_precision[1] * left.y,
        focal_length_ * observation.disparity_precision * (left.x - right.x)};
#pragma GCC unroll 1
    for (int i = view.isAnchor() ? ObservationRows::kDisparity : 0; i < ObservationRows::kCount; ++i)
      add(rows.row[i], by_offset[i]);
  }

  void eliminate(const DepthBlock& depth, const PoseLanes* by_poses) {
    const DoubleLanes weighted = depth.variance * by_depth_;
    for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
#pragma GCC unroll 1
      for (int axis = 0; axis < 6; ++axis)
        by_poses_[pose].value[axis] -= weighted * by_poses[pose].value[axis];
    by_depths_.push_back({by_depth_});
  }

  /// Writes `dpose_doffset` of the free poses and `dinverse_depth_doffset` of the landmarks.
  void conclude(const Eigen::LDLT<PoseMatrix>& factor, const ReducedSystem& system, const PosePriors& priors,
                const BundleBlocks& blocks, BundleProblem& problem) const;

 private:
  struct Change {
    BundleCameras::Change left, right;
  };
  struct DepthLanes {
    DoubleLanes value;
  };

  void add(const RowLanes& row, const DoubleLanes& by_offset) {
    const DoubleLanes weighted = row.weight * by_offset;
    by_depth_ += weighted * row.by_inverse_depth;
#pragma GCC unroll 1
    for (int a = 0; a < row.poses; ++a)
#pragma GCC unroll 1
      for (int axis = 0; axis < 6; ++axis)
        by_poses_[row.pose[a]].value[axis] += weighted * row.by_pose[a].value[axis];
  }

  int count_ = 0;
  double focal_length_ = 0.0;
  std::vector<Change> changes_;  // by camera, then by anchor
  PoseSums by_poses_;
  DoubleLanes by_depth_{};  // current block
  std::vector<DepthLanes> by_depths_;
};

}  // namespace cartvo::vo
