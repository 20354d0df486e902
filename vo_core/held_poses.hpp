#pragma once

#include "vo_core/reduced_system.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// What holds free poses where they start (BundleProblem::held), as measurements of them.
class HeldPoses {
 public:
  void reset(const BundleProblem& problem) {
    starts_.clear();
    for (int i = problem.fixed; i < static_cast<int>(problem.held.size()); ++i)
      starts_.push_back({problem.poses[i].T_world_camera, problem.poses[i].by_late_right, problem.held[i]});
  }

  /// Adds them to normal equations that are concluded for these poses.
  void pull(const BundleProblem& problem, ReducedSystem& system) const {
    for (int i = 0; i < static_cast<int>(starts_.size()); ++i) {
      const Eigen::Isometry3d& pose = problem.poses[problem.fixed + i].T_world_camera;
      system.hessian.block<6, 6>(6 * i, 6 * i) += starts_[i].information;
      system.gradient.segment<6>(6 * i) +=
          starts_[i].information * vectorFromMotion(pose.inverse() * starts_[i].T_world_camera);
    }
  }

  /// How the gradient changes with the delay by which the starts err already (LateRight).
  PoseVector pullByLateRight(Eigen::Index unknowns) const {
    PoseVector pull = PoseVector::Zero(unknowns);
    for (int i = 0; i < static_cast<int>(starts_.size()); ++i)
      pull.segment<6>(6 * i) = starts_[i].information * starts_[i].by_late_right;
    return pull;
  }

 private:
  struct Start {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    Vector6d by_late_right = Vector6d::Zero();
    Matrix6d information = Matrix6d::Zero();
  };
  FixedVector<Start, kMostWindowPairs> starts_;
};

}  // namespace cartvo
