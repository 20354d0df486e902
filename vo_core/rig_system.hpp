#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "vo_core/reduced_system.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// What the residuals say of the rig's correction and the window's scale, the inverse depths eliminated.
class RigSystem {
 public:
  RigSystem() = default;
  explicit RigSystem(const BundleProblem& problem) : camera_(problem.camera) {
    by_poses_.resize(problem.poses.size() - problem.fixed);
  }

  // Visits of ReducedSystem::build().
  void begin() {
    for (DoubleLanes& derivative : by_depth_)
      derivative = DoubleLanes{};
  }

  /// A disparity: of the rest, positions in the left image, the rig is no part.
  void add(const BlockView& view, const RowLanes& row) {
    const DoubleLanes f = camera_.focal_length * view.sighting.disparity_precision;
    const DoubleLanes x = (view.sighting.right[0] - camera_.cx) / camera_.focal_length;
    const DoubleLanes y = (view.sighting.right[1] - camera_.cy) / camera_.focal_length;
    // Of the column as correctedRight() has it, by yaw and bend; and by the scale.
    // The scale's is predicted, not measured: the noise of what is measured would take part in its own
    // derivative, and a bias come of it. Of the disparity, what the baseline makes; what the motion since the
    // left exposure makes scales with the window.
    const DoubleLanes by_shared[kShared] = {
        f * (1.0 + x * x), f * (3.0 * (x * x) + y * y),
        f * (camera_.baseline * view.place.inverse_depth * view.right.inverse_z)};
#pragma GCC unroll 1
    for (int i = 0; i < kShared; ++i) {
      const DoubleLanes weighted = row.weight * by_shared[i];
      for (int j = 0; j <= i; ++j)
        hessian_[i][j] += weighted * by_shared[j];
      gradient_[i] += weighted * row.residual;
      by_depth_[i] += weighted * row.by_inverse_depth;
#pragma GCC unroll 1
      for (int a = 0; a < row.poses; ++a)
#pragma GCC unroll 1
        for (int axis = 0; axis < 6; ++axis)
          by_poses_[row.pose[a]].of[i].value[axis] += weighted * row.by_pose[a].value[axis];
    }
  }

  void eliminate(const DepthBlock& depth, const PoseLanes* by_poses) {
#pragma GCC unroll 1
    for (int i = 0; i < kShared; ++i) {
      const DoubleLanes weighted = depth.variance * by_depth_[i];
      for (int j = 0; j <= i; ++j)
        hessian_[i][j] -= weighted * by_depth_[j];
      gradient_[i] -= weighted * depth.gradient;
      for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
#pragma GCC unroll 1
        for (int axis = 0; axis < 6; ++axis)
          by_poses_[pose].of[i].value[axis] -= weighted * by_poses[pose].value[axis];
    }
  }

  /// Eliminates the poses and the scale.
  void conclude(const ReducedSystem& system, const Eigen::LDLT<PoseMatrix>& factor,
                BundleResult& result) const;

 private:
  /// The rig's correction, which disparities tell of, and the window's scale.
  static constexpr int kShared = RigCorrection::kSize + 1;
  struct SharedByPose {
    PoseLanes of[kShared];
  };

  StereoCamera camera_;
  DoubleLanes hessian_[kShared][kShared]{};  // the lower triangle
  DoubleLanes gradient_[kShared]{};
  DoubleLanes by_depth_[kShared]{};  // of the present block
  FixedVector<SharedByPose, kMostWindowPairs> by_poses_;
};

}  // namespace cartvo
