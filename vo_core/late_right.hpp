#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "vo_core/reduced_system.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// How the result errs if all right cameras were exposed later than their offsets say. With the state x, the
/// unmodelled delay d, the residuals z - h(x, d) and the poses that stand wrong by P d already (H: the
/// Hessian),
///
///   dx = H^-1 J^T W (dh/dd - J_standing P) d:
///
/// the consideration of a parameter that is not estimated (S. Schmidt, "Application of state-space methods to
/// navigation problems", 1966).
class LateRight {
 public:
  explicit LateRight(const BundleProblem& problem);

  void add(std::size_t landmark, const std::vector<BundleRow>& rows, const DepthEquation& depth);

  /// Writes `by_late_right` of the free poses and of the landmarks.
  void conclude(const Eigen::LDLT<Eigen::MatrixXd>& factor, const std::vector<DepthEquation>& depths,
                BundleProblem& problem) const;

 private:
  const BundleProblem& problem_;
  Eigen::VectorXd by_poses_;
  std::vector<double> by_depth_;
};

}  // namespace cartvo
