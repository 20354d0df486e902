#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "vo_core/reduced_system.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// What the residuals say of the rig's correction and the window's scale, the inverse depths eliminated.
class RigSystem {
 public:
  explicit RigSystem(const BundleProblem& problem);

  /// One landmark's residuals.
  void add(const std::vector<BundleRow>& rows, const DepthEquation& depth);

  /// Eliminates the poses and the scale.
  void conclude(const ReducedSystem& system, const Eigen::LDLT<Eigen::MatrixXd>& factor,
                BundleResult& result) const;

 private:
  using CrossMatrix = Eigen::Matrix<double, Eigen::Dynamic, kShared>;
  int fixed_;
  SharedMatrix hessian_ = SharedMatrix::Zero();
  SharedVector gradient_ = SharedVector::Zero();
  CrossMatrix by_poses_;
};

}  // namespace cartvo
