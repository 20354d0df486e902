// The depths' elimination by the Schur complement.
#include "vo_core/reduced_system.hpp"

namespace cartvo {
namespace {

constexpr double kLeastDepthInformation = 1e-9;

}  // namespace

void ReducedSystem::add(const BundleLandmark& landmark, const std::vector<BundleRow>& rows,
                        DepthEquation& depth) {
  depth.by_poses = Eigen::VectorXd::Zero(size_);
  depth.hessian = landmark.prior_information;
  depth.gradient = landmark.prior_information * (landmark.prior_inverse_depth - landmark.inverse_depth);
  for (const BundleRow& row : rows) {
    depth.hessian += row.weight * row.by_inverse_depth * row.by_inverse_depth;
    depth.gradient += row.weight * row.by_inverse_depth * row.residual;
    for (int a = 0; a < row.poses; ++a) {
      const int at_a = 6 * (row.pose[a] - fixed_);
      if (at_a < 0) continue;
      const RowVector6d weighted = row.weight * row.by_pose[a];
      gradient.segment<6>(at_a) += weighted.transpose() * row.residual;
      depth.by_poses.segment<6>(at_a) += weighted.transpose() * row.by_inverse_depth;
      for (int b = 0; b < row.poses; ++b) {
        const int at_b = 6 * (row.pose[b] - fixed_);
        if (at_b < 0 || at_b > at_a) continue;
        hessian.block<6, 6>(at_a, at_b).noalias() += weighted.transpose() * row.by_pose[b];
      }
    }
  }
  if (depth.hessian < kLeastDepthInformation) {
    depth.hessian = 0.0;
    return;
  }
  hessian.selfadjointView<Eigen::Lower>().rankUpdate(depth.by_poses, -1.0 / depth.hessian);
  gradient -= depth.by_poses * (depth.gradient / depth.hessian);
}

}  // namespace cartvo
