// Normal equations of the rig's correction.
#include "vo_core/rig_system.hpp"

namespace cartvo {
namespace {

constexpr double kScaleInformation = 1.0 / (0.05 * 0.05);  // of a window whose scale is not known

}  // namespace

RigSystem::RigSystem(const BundleProblem& problem)
    : fixed_(problem.fixed),
      by_poses_(CrossMatrix::Zero(6 * (static_cast<int>(problem.poses.size()) - problem.fixed), kShared)) {}

void RigSystem::add(const std::vector<BundleRow>& rows, const DepthEquation& depth) {
  if (!(depth.hessian > 0.0)) return;
  SharedVector by_depth = SharedVector::Zero();
  for (const BundleRow& row : rows) {
    const SharedVector weighted = row.weight * row.by_shared;
    hessian_ += weighted * row.by_shared.transpose();
    gradient_ += weighted * row.residual;
    by_depth += weighted * row.by_inverse_depth;
    for (int a = 0; a < row.poses; ++a)
      if (const int at = 6 * (row.pose[a] - fixed_); at >= 0)
        by_poses_.middleRows<6>(at) += row.by_pose[a].transpose() * weighted.transpose();
  }
  hessian_ -= by_depth * by_depth.transpose() / depth.hessian;
  gradient_ -= by_depth * (depth.gradient / depth.hessian);
  by_poses_ -= depth.by_poses * (by_depth.transpose() / depth.hessian);
}

void RigSystem::conclude(const ReducedSystem& system, const Eigen::LDLT<Eigen::MatrixXd>& factor,
                         BundleResult& result) const {
  const CrossMatrix solved = factor.solve(by_poses_);
  SharedMatrix hessian = hessian_ - by_poses_.transpose() * solved;
  const SharedVector gradient = gradient_ - solved.transpose() * system.gradient;
  hessian(kShared - 1, kShared - 1) += kScaleInformation;
  constexpr int n = RigCorrection::kSize;
  const RigCorrection::Vector by_scale = hessian.topRightCorner<n, 1>();
  result.rig_information = hessian.topLeftCorner<n, n>() - by_scale * by_scale.transpose() / hessian(n, n);
  result.rig_gradient = gradient.head<n>() - by_scale * (gradient[n] / hessian(n, n));
}

}  // namespace cartvo
