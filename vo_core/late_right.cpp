// What a delay that nobody knows does to a bundle's result.
#include "vo_core/late_right.hpp"

namespace cartvo {

LateRight::LateRight(const BundleProblem& problem)
    : problem_(problem),
      by_poses_(Eigen::VectorXd::Zero(6 * (static_cast<int>(problem.poses.size()) - problem.fixed))),
      by_depth_(problem.landmarks.size(), 0.0) {}

void LateRight::add(std::size_t landmark, const std::vector<BundleRow>& rows, const DepthEquation& depth) {
  if (!(depth.hessian > 0.0)) return;
  const BundleLandmark& item = problem_.landmarks[landmark];
  double by_depth = item.prior_information * item.prior_by_late_right;
  for (const BundleRow& row : rows) {
    double by_delay = row.by_late_right;
    for (int a = 0; a < row.poses; ++a)
      if (row.pose[a] < problem_.fixed)
        by_delay -= row.by_pose[a].dot(problem_.poses[row.pose[a]].by_late_right.transpose());
    const double weighted = row.weight * by_delay;
    by_depth += weighted * row.by_inverse_depth;
    for (int a = 0; a < row.poses; ++a)
      if (const int at = 6 * (row.pose[a] - problem_.fixed); at >= 0)
        by_poses_.segment<6>(at) += weighted * row.by_pose[a].transpose();
  }
  by_poses_ -= depth.by_poses * (by_depth / depth.hessian);
  by_depth_[landmark] = by_depth;
}

void LateRight::conclude(const Eigen::LDLT<Eigen::MatrixXd>& factor, const std::vector<DepthEquation>& depths,
                         BundleProblem& problem) const {
  const Eigen::VectorXd by_delay = factor.solve(by_poses_);
  for (std::size_t i = static_cast<std::size_t>(problem.fixed); i < problem.poses.size(); ++i)
    problem.poses[i].by_late_right = by_delay.segment<6>(6 * (static_cast<Eigen::Index>(i) - problem.fixed));
  for (std::size_t i = 0; i < depths.size(); ++i)
    if (depths[i].hessian > 0.0)
      problem.landmarks[i].by_late_right =
          (by_depth_[i] - depths[i].by_poses.dot(by_delay)) / depths[i].hessian;
}

}  // namespace cartvo
