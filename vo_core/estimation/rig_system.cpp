// Solution of the normal equations of the rig's correction and the window's scale.
#include "vo_core/estimation/rig_system.hpp"

namespace cartvo::vo {

void RigSystem::conclude(const ReducedSystem& system, const Eigen::LDLT<PoseMatrix>& factor,
                         BundleResult& result) const {
  Eigen::Matrix<double, kShared, kShared> hessian;
  Eigen::Matrix<double, kShared, 1> gradient;
  using SharedByPoses = Eigen::Matrix<double, Eigen::Dynamic, kShared, 0, kMaximumPoseUnknowns, kShared>;
  SharedByPoses by_poses(system.gradient.size(), kShared);
  for (int i = 0; i < kShared; ++i) {
    for (int j = 0; j <= i; ++j)
      hessian(i, j) = hessian(j, i) = sumOf(hessian_[i][j]);
    gradient[i] = sumOf(gradient_[i]);
    for (int pose = 0; pose < static_cast<int>(by_poses_.size()); ++pose)
      for (int axis = 0; axis < 6; ++axis)
        by_poses(6 * pose + axis, i) = sumOf(by_poses_[pose].of[i].value[axis]);
  }
  const SharedByPoses solved = factor.solve(by_poses);
  hessian -= by_poses.transpose() * solved;
  gradient -= solved.transpose() * system.gradient;
  constexpr int n = RigCorrection::kSize;
  hessian(n, n) += scale_information_;
  result.scale_variance = 1.0 / hessian(n, n);
  const RigCorrection::Vector by_scale = hessian.topRightCorner<n, 1>();
  result.rig_information = hessian.topLeftCorner<n, n>() - by_scale * by_scale.transpose() / hessian(n, n);
  result.rig_gradient = gradient.head<n>() - by_scale * (gradient[n] / hessian(n, n));
}

}  // namespace cartvo::vo
