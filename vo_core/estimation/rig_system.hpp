#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "vo_core/estimation/reduced_system.hpp"

// Normal equations of the rig calibration error, from the disparities of a bundle problem. Internal to the
// bundle adjustment.

namespace cartvo::vo {

/// Normal equations of the rig's correction and the window's scale after elimination of the inverse depths.
class RigSystem {
 public:
  RigSystem() = default;
  explicit RigSystem(const BundleProblem& problem)
      : camera_(problem.camera), scale_information_(1.0 / (problem.scale_stddev * problem.scale_stddev)) {
    by_poses_.resize(problem.poses.size() - problem.fixed);
  }

  // Callbacks of ReducedSystem::build().
  void begin() {
    for (DoubleLanes& derivative : by_depth_)
      derivative = DoubleLanes{};
  }

  /// Adds a disparity residual. Positions in the left image do not depend on the rig.
  void add(const BlockView& view, const RowLanes& row) {
    const DoubleLanes f = camera_.focal_length * view.observation.disparity_precision;
    const DoubleLanes x = (view.observation.right[0] - camera_.cx) / camera_.focal_length;
    const DoubleLanes y = (view.observation.right[1] - camera_.cy) / camera_.focal_length;
    // Derivatives of the right column by yaw and p2 as in correctedRight(), and by the scale.
    // The derivative by scale uses the predicted disparity: measurement noise in the derivative would bias
    // the scale. It has only the part due to the baseline; the part due to the motion since the left exposure
    // scales with the window.
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

  /// Eliminates the poses and the scale; sets `rig_information`, `rig_gradient` and `scale_variance`.
  void conclude(const ReducedSystem& system, const Eigen::LDLT<PoseMatrix>& factor,
                BundleResult& result) const;

 private:
  /// Components of the rig's correction that disparities observe, and the window's scale.
  static constexpr int kShared = RigCorrection::kSize + 1;
  struct SharedByPose {
    PoseLanes of[kShared];
  };

  StereoCamera camera_;
  double scale_information_ = 0.0;           // prior of the window's scale factor
  DoubleLanes hessian_[kShared][kShared]{};  // the lower triangle
  DoubleLanes gradient_[kShared]{};
  DoubleLanes by_depth_[kShared]{};  // current block
  FixedVector<SharedByPose, kMaximumWindowPairs> by_poses_;
};

}  // namespace cartvo::vo
