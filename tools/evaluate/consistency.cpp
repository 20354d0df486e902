// The normalised estimation error squared (NEES) and the band of its mean.
#include "tools/evaluate/consistency.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace cartvo {
namespace {

constexpr double kDimension = 6.0;
constexpr double kTailProbability = 0.025;

/// Probability that chi-square with 2 `half_dof` degrees of freedom exceeds 2 `half_value`. For an even
/// number of degrees of freedom the incomplete gamma function is a sum of Poisson probabilities (M.
/// Abramowitz, I. Stegun, 26.4.21).
double probabilityAbove(double half_value, std::size_t half_dof) {
  double sum = 0.0;
  for (std::size_t i = 0; i < half_dof; ++i) {
    const auto k = static_cast<double>(i);
    sum += std::exp(k * std::log(half_value) - half_value - std::lgamma(k + 1.0));
  }
  return sum;
}

/// The value that the mean of `count` values of chi-square(6) / 6 exceeds with `probability`, by bisection.
double meanExceeded(double probability, std::size_t count) {
  const std::size_t half_dof = 3 * count;
  const double ten_stddevs = 10.0 * std::sqrt(2.0 / (kDimension * static_cast<double>(count)));
  double low = std::max(1e-6, 1.0 - ten_stddevs);
  double high = 1.0 + ten_stddevs;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    const bool is_below = probabilityAbove(middle * static_cast<double>(half_dof), half_dof) > probability;
    (is_below ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Interval consistencyBand(std::size_t count) {
  return {meanExceeded(1.0 - kTailProbability, count), meanExceeded(kTailProbability, count)};
}

void NormalisedErrors::add(const vo::Vector6d& error, const vo::Matrix6d& covariance) {
  const Eigen::LLT<vo::Matrix6d> factor(covariance);
  const bool is_usable = covariance.allFinite() && error.allFinite() && factor.info() == Eigen::Success;
  if (!is_usable) {
    ++unusable_;
    return;
  }
  if (!group_open_) groups_.emplace_back();
  group_open_ = true;
  groups_.back().sum += error.dot(factor.solve(error)) / kDimension;
  ++groups_.back().count;
}

double NormalisedErrors::mean() const {
  double sum = 0.0;
  for (const Group& group : groups_)
    sum += group.sum / static_cast<double>(group.count);
  return sum / static_cast<double>(groups_.size());
}

}  // namespace cartvo
