#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"

// Relative poses of all cameras of a bundle problem and their derivatives. Internal to the bundle adjustment.

namespace cartvo::vo {

/// Transforms from every left camera of a problem to every left and right camera.
class BundleCameras {
 public:
  using Change = Eigen::Matrix<double, 3, 4>;  // derivative of [R t]

  void reset(const BundleProblem& problem);

  /// Recomputes the transforms after a change of the free poses.
  void update(const BundleProblem& problem);

  const Eigen::Isometry3d& leftFromAnchor(int camera, int anchor) const {
    return T_left_anchor_[index(camera, anchor)];
  }
  const Eigen::Isometry3d& rightFromAnchor(int camera, int anchor) const {
    return T_right_anchor_[index(camera, anchor)];
  }
  const RightCamera& right(int camera) const { return right_[camera]; }

  /// Whether the pose of the right camera depends on a free pose.
  bool rightIsFree(int camera) const;

  /// Derivatives of T_left_anchor and T_right_anchor by an error of the time offset (1/s): its direct effect
  /// on the right camera and the error that it has caused in fixed poses.
  Change leftByTimeOffset(const BundleProblem& problem, int camera, int anchor) const;
  Change rightByTimeOffset(const BundleProblem& problem, int camera, int anchor) const;

 private:
  std::size_t index(int camera, int anchor) const { return camera * count_ + anchor; }

  int count_ = 0;
  int fixed_ = 0;
  std::vector<RightCamera> right_;
  std::vector<Eigen::Isometry3d> T_left_anchor_, T_right_anchor_;
};

}  // namespace cartvo::vo
