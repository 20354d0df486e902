// Where the cameras of a bundle are, and how a delay moves them.
#include "vo_core/bundle_cameras.hpp"

namespace cartvo {
namespace {

/// Of T = T_camera_host by perturbations, on the right, of both.
BundleCameras::Change changeOf(const Eigen::Isometry3d& T, const Vector6d& camera, const Vector6d& host) {
  BundleCameras::Change change;
  change.leftCols<3>() = T.linear() * skew(host.tail<3>()) - skew(camera.tail<3>()) * T.linear();
  change.col(3) = T.linear() * host.head<3>() - camera.head<3>() - camera.tail<3>().cross(T.translation());
  return change;
}

/// What a delay has done to a pose, if it stands: to undo it is what its residuals ask for.
Vector6d undone(const BundleProblem& problem, int pose) {
  if (pose < 0 || pose >= problem.fixed) return Vector6d::Zero();
  return -problem.poses[pose].by_late_right;
}

}  // namespace

void BundleCameras::take(const BundleProblem& problem) {
  count_ = static_cast<int>(problem.poses.size());
  fixed_ = problem.fixed;
  T_left_host_.resize(problem.poses.size() * problem.poses.size());
  T_right_host_.resize(T_left_host_.size());
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
    for (int host = 0; host < count_; ++host) {
      const Eigen::Isometry3d& T_world_host = problem.poses[host].T_world_camera;
      T_left_host_[place(camera, host)] = left_inverse * T_world_host;
      T_right_host_[place(camera, host)] = right_inverse * T_world_host;
    }
  }
}

bool BundleCameras::rightIsFree(int camera) const {
  return camera >= fixed_ || right(camera).neighbour >= fixed_ || right(camera).third >= fixed_;
}

BundleCameras::Change BundleCameras::leftByLateRight(const BundleProblem& problem, int camera,
                                                     int host) const {
  return changeOf(leftFromHost(camera, host), undone(problem, camera), undone(problem, host));
}

BundleCameras::Change BundleCameras::rightByLateRight(const BundleProblem& problem, int camera,
                                                      int host) const {
  const RightCamera& from = right(camera);
  const Vector6d moved = from.by_offset + from.by_own * undone(problem, camera) +
                         from.by_neighbour * undone(problem, from.neighbour) +
                         from.by_third * undone(problem, from.third);
  return changeOf(rightFromHost(camera, host), moved, undone(problem, host));
}

}  // namespace cartvo
