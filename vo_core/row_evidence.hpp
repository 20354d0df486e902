#pragma once

#include <Eigen/Core>
#include <memory>

#include "vo_core/bundle_adjustment.hpp"

namespace cartvo {

/// What makes a stereo match lie in another row of the right image than the motion says. `keystone` is what
/// shifts rows in proportion to x * y: a yaw does, but the lenses of a good calibration leave over more of it
/// than a yaw that matters; so it is estimated to keep it out of the others, and believed by nobody.
struct RowErrors {
  static constexpr int kSize = 4;
  enum Index { kPitch, kRoll, kKeystone, kDelay };  ///< rad, rad, rad, s; signs as RigCorrection's
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
};

/// What one pair tells of its rows.
struct RowEvidence {
  RowErrors::Vector errors = RowErrors::Vector::Zero();       ///< beyond what was corrected
  RowErrors::Matrix information = RowErrors::Matrix::Zero();  ///< zero if there are too few matches
  /// Mean product of the rows' derivatives by the errors, px^2: how much a pattern of the rows that nobody
  /// models would disturb them.
  RowErrors::Matrix leverage = RowErrors::Matrix::Zero();
};

/// Robust regression of the newest pair's vertical disparities. What is explained by the motion between the
/// two exposures of an unsynchronised pair is taken off before.
class RowRegression {
 public:
  RowRegression();
  RowRegression(RowRegression&&) noexcept;
  RowRegression& operator=(RowRegression&&) noexcept;
  ~RowRegression();

  RowEvidence evidence(const BundleProblem& adjusted);

 private:
  struct Work;
  std::unique_ptr<Work> work_;  // kept from problem to problem for its memory
};

/// For a single problem.
RowEvidence rowEvidence(const BundleProblem& adjusted);

}  // namespace cartvo
