// What a delay that nobody knows does to a bundle's result.
#include "vo_core/late_right.hpp"

namespace cartvo {

void LateRight::reset(const BundleProblem& problem, const BundleCameras& cameras,
                      const BundleBlocks& blocks) {
  count_ = static_cast<int>(problem.poses.size());
  focal_length_ = problem.camera.focal_length;
  by_poses_.clear();
  by_poses_.resize(problem.poses.size() - problem.fixed);
  changes_.clear();
  by_depths_.clear();
  for (int camera = 0; camera < count_; ++camera)
    for (int host = 0; host < count_; ++host)
      changes_.push_back(
          {cameras.leftByLateRight(problem, camera, host), cameras.rightByLateRight(problem, camera, host)});
  by_depths_.reserve(blocks.landmarks.capacity());
}

void LateRight::conclude(const Eigen::LDLT<PoseMatrix>& factor, const ReducedSystem& system,
                         const HeldPoses& held, const BundleBlocks& blocks, BundleProblem& problem) const {
  const PoseVector by_delay = factor.solve(sumOf(by_poses_) + held.pullByLateRight(system.gradient.size()));
  for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
    problem.poses[problem.fixed + pose].by_late_right = by_delay.segment<6>(6 * pose);
  for (std::size_t i = 0; i < blocks.landmarks.size(); ++i) {
    const LandmarkBlock& block = blocks.landmarks[i];
    DoubleLanes by_depth = by_depths_[i].value;
    for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
      for (int axis = 0; axis < 6; ++axis)
        by_depth -= by_delay[6 * pose + axis] * system.byPoses(i)[pose].value[axis];
    by_depth *= system.depths[i].variance;
    for (int lane = 0; lane < block.count; ++lane)
      problem.landmarks[block.landmark[lane]].by_late_right = by_depth[lane];
  }
}

}  // namespace cartvo
