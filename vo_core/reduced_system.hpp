#pragma once

#include <Eigen/Core>
#include <vector>

#include "vo_core/bundle_residuals.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// How one landmark's inverse depth hangs together with the poses.
struct DepthEquation {
  double hessian = 0.0;
  double gradient = 0.0;
  Eigen::VectorXd by_poses;
};

/// The normal equations, the inverse depths eliminated.
class ReducedSystem {
 public:
  explicit ReducedSystem(const BundleProblem& problem)
      : fixed_(problem.fixed), size_(6 * (static_cast<int>(problem.poses.size()) - problem.fixed)) {}

  /// `visit(i, rows, depth)` sees each landmark's residuals, and none of one behind a camera.
  template <typename Visit>
  void build(const BundleProblem& problem, const BundleCameras& cameras, double robust_width,
             const Visit& visit) {
    hessian = Eigen::MatrixXd::Zero(size_, size_);
    gradient = Eigen::VectorXd::Zero(size_);
    depths.assign(problem.landmarks.size(), {});
    LandmarkRows rows(problem, cameras, robust_width);
    for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
      if (!rows.linearise(problem.landmarks[i])) continue;
      add(problem.landmarks[i], rows.rows(), depths[i]);
      visit(i, rows.rows(), depths[i]);
    }
    hessian.triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  }

  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  std::vector<DepthEquation> depths;

 private:
  void add(const BundleLandmark& landmark, const std::vector<BundleRow>& rows, DepthEquation& depth);

  int fixed_;
  int size_;
};

}  // namespace cartvo
