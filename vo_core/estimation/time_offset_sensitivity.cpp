// Sensitivity of a bundle adjustment's result to the time offset.
#include "vo_core/estimation/time_offset_sensitivity.hpp"

namespace cartvo::vo {

void TimeOffsetSensitivity::reset(const BundleProblem& problem, const BundleCameras& cameras,
                                  const BundleBlocks& blocks) {
  count_ = static_cast<int>(problem.poses.size());
  focal_length_ = problem.camera.focal_length;
  by_poses_.clear();
  by_poses_.resize(problem.poses.size() - problem.fixed);
  changes_.clear();
  by_depths_.clear();
  for (int camera = 0; camera < count_; ++camera)
    for (int anchor = 0; anchor < count_; ++anchor)
      changes_.push_back({cameras.leftByTimeOffset(problem, camera, anchor),
                          cameras.rightByTimeOffset(problem, camera, anchor)});
  by_depths_.reserve(blocks.landmarks.capacity());
}

void TimeOffsetSensitivity::conclude(const Eigen::LDLT<PoseMatrix>& factor, const ReducedSystem& system,
                                     const PosePriors& priors, const BundleBlocks& blocks,
                                     BundleProblem& problem) const {
  const PoseVector by_offset =
      factor.solve(sumOf(by_poses_) + priors.gradientByTimeOffset(system.gradient.size()));
  for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
    problem.poses[problem.fixed + pose].dpose_doffset = by_offset.segment<6>(6 * pose);
  for (std::size_t i = 0; i < blocks.landmarks.size(); ++i) {
    const LandmarkBlock& block = blocks.landmarks[i];
    DoubleLanes by_depth = by_depths_[i].value;
    for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
      for (int axis = 0; axis < 6; ++axis)
        by_depth -= by_offset[6 * pose + axis] * system.byPoses(i)[pose].value[axis];
    by_depth *= system.depths[i].variance;
    for (int lane = 0; lane < block.count; ++lane)
      problem.landmarks[block.landmark[lane]].dinverse_depth_doffset = by_depth[lane];
  }
}

}  // namespace cartvo::vo
