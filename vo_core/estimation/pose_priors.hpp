#pragma once

#include "vo_core/estimation/reduced_system.hpp"

// Priors on the free poses of a bundle problem. Internal to the bundle adjustment.

namespace cartvo::vo {

/// Priors that tie free poses to their initial values (BundleProblem::pose_prior_information).
class PosePriors {
 public:
  void reset(const BundleProblem& problem) {
    starts_.clear();
    for (int i = problem.fixed; i < static_cast<int>(problem.pose_prior_information.size()); ++i)
      starts_.push_back({problem.poses[i].T_world_camera, problem.poses[i].dpose_doffset,
                         problem.pose_prior_information[i]});
  }

  /// Adds the priors, linearised at the present poses of `problem`, to the summed normal equations.
  void addTo(ReducedSystem& system, const BundleProblem& problem) const {
    for (int i = 0; i < static_cast<int>(starts_.size()); ++i) {
      const Eigen::Isometry3d& pose = problem.poses[problem.fixed + i].T_world_camera;
      system.hessian.block<6, 6>(6 * i, 6 * i) += starts_[i].information;
      system.gradient.segment<6>(6 * i) +=
          starts_[i].information * vectorFromMotion(pose.inverse() * starts_[i].T_world_camera);
    }
  }

  /// Derivative of the gradient by the error of the time offset, due to the errors of the initial poses.
  PoseVector gradientByTimeOffset(Eigen::Index unknowns) const {
    PoseVector derivative = PoseVector::Zero(unknowns);
    for (int i = 0; i < static_cast<int>(starts_.size()); ++i)
      derivative.segment<6>(6 * i) = starts_[i].information * starts_[i].dpose_doffset;
    return derivative;
  }

 private:
  struct Start {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    Vector6d dpose_doffset = Vector6d::Zero();
    Matrix6d information = Matrix6d::Zero();
  };
  FixedVector<Start, kMaximumWindowPairs> starts_;
};

}  // namespace cartvo::vo
