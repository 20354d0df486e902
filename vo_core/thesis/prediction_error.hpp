#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/statistics.hpp"

namespace cartvo::vo {

/// Prediction error c of a feature (thesis 4.16) in standard deviations of its point: |L^-1 error| with
/// covariance = L L^T. `information`: inverse of the covariance. The thesis takes the error in metres and one
/// radius for all; a point 40 m away then never passes, or a moving one 4 m away always does.
inline double normalisedError(const Eigen::Vector3d& error, const Eigen::Matrix3d& information) {
  return std::sqrt(std::max(error.dot(information * error), 0.0));
}

/// Weight of a feature with prediction error c (thesis 4.16): 1/c below the radius, 0 beyond. Constant below
/// one standard deviation: a feature that fits by chance must not decide the motion.
inline double errorWeight(double error, double radius) {
  if (!(error < radius)) return 0.0;
  return error > 1.0 ? 1.0 / error : 1.0;
}

/// Median of |L^-1 e| for a Gaussian e in three dimensions (chi distribution).
constexpr double kMedianOfChi3 = 1.538;
constexpr double kMaximumErrorScale = 4.0;

/// Ratio of the errors to the assumed noise, in [1, kMaximumErrorScale], from their median: half of the
/// matches may be wrong.
inline double errorScale(std::vector<double> errors) {
  if (errors.empty()) return 1.0;
  return std::clamp(median(errors) / kMedianOfChi3, 1.0, kMaximumErrorScale);
}

}  // namespace cartvo::vo
