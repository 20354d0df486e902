// Camera transforms of a bundle problem and their derivatives by the time offset.
#include "vo_core/estimation/bundle_cameras.hpp"

namespace cartvo::vo {
namespace {

/// Derivative of T = T_camera_anchor by perturbations, on the right, of both poses.
BundleCameras::Change changeOf(const Eigen::Isometry3d& T, const Vector6d& camera, const Vector6d& anchor) {
  BundleCameras::Change change;
  change.leftCols<3>() = T.linear() * skew(anchor.tail<3>()) - skew(camera.tail<3>()) * T.linear();
  change.col(3) = T.linear() * anchor.head<3>() - camera.head<3>() - camera.tail<3>().cross(T.translation());
  return change;
}

/// Minus the sensitivity of a fixed pose to the time offset, the correction its residuals ask for; zero for a
/// free pose.
Vector6d fixedPoseCorrection(const BundleProblem& problem, int pose) {
  if (pose < 0 || pose >= problem.fixed) return Vector6d::Zero();
  return -problem.poses[pose].dpose_doffset;
}

}  // namespace

void BundleCameras::reset(const BundleProblem& problem) {
  count_ = static_cast<int>(problem.poses.size());
  fixed_ = problem.fixed;
  T_left_anchor_.resize(problem.poses.size() * problem.poses.size());
  T_right_anchor_.resize(T_left_anchor_.size());
  right_.clear();
  for (int i = 0; i < count_; ++i)
    right_.push_back(rightCameraOf(problem.poses, i, problem.camera.baseline));
  update(problem);
}

void BundleCameras::update(const BundleProblem& problem) {
  for (int i = 0; i < count_; ++i)
    if (rightIsFree(i)) right_[i] = rightCameraOf(problem.poses, i, problem.camera.baseline);
  for (int camera = 0; camera < count_; ++camera) {
    const Eigen::Isometry3d left_inverse = problem.poses[camera].T_world_camera.inverse();
    const Eigen::Isometry3d right_inverse = right(camera).T_world_camera.inverse();
    for (int anchor = 0; anchor < count_; ++anchor) {
      const Eigen::Isometry3d& T_world_anchor = problem.poses[anchor].T_world_camera;
      T_left_anchor_[index(camera, anchor)] = left_inverse * T_world_anchor;
      T_right_anchor_[index(camera, anchor)] = right_inverse * T_world_anchor;
    }
  }
}

bool BundleCameras::rightIsFree(int camera) const {
  return camera >= fixed_ || right(camera).neighbour >= fixed_ || right(camera).third >= fixed_;
}

BundleCameras::Change BundleCameras::leftByTimeOffset(const BundleProblem& problem, int camera,
                                                      int anchor) const {
  return changeOf(leftFromAnchor(camera, anchor), fixedPoseCorrection(problem, camera),
                  fixedPoseCorrection(problem, anchor));
}

BundleCameras::Change BundleCameras::rightByTimeOffset(const BundleProblem& problem, int camera,
                                                       int anchor) const {
  const RightCamera& from = right(camera);
  const Vector6d moved = from.by_offset + from.by_own * fixedPoseCorrection(problem, camera) +
                         from.by_neighbour * fixedPoseCorrection(problem, from.neighbour) +
                         from.by_third * fixedPoseCorrection(problem, from.third);
  return changeOf(rightFromAnchor(camera, anchor), moved, fixedPoseCorrection(problem, anchor));
}

}  // namespace cartvo::vo
