// Estimates a readout by a filter; the scatter of the images tells how far they can be trusted.
#include "vo_core/self_calibration/readout_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

double square(double value) {
  return value * value;
}

}  // namespace

ReadoutEstimator::ReadoutEstimator(const Shutter& shutter, const SelfCalibrationSettings& settings)
    : known_(shutter.readout_stddev == 0.0),
      model_stddev_(settings.readout_model_stddev),
      innovation_limit_(settings.innovation_limit),
      prior_variance_(square(known_ ? settings.readout_stddev : shutter.readout_stddev)),
      used_(shutter.readout),
      estimate_(shutter.readout),
      variance_(prior_variance_) {}

void ReadoutEstimator::update(const ReadoutEquation& equation) {
  const double measured = used_ + equation.gradient / equation.information;
  const double variance = readout::kSharingImages / equation.information;
  if (equation.information > 0.0 && std::isfinite(measured) && std::isfinite(variance))
    addImage(measured, variance);
}

void ReadoutEstimator::set(const EstimateWithStddev& estimate) {
  if (known_) return;
  used_ = estimate_ = estimate.value;
  variance_ = square(estimate.stddev);
}

/// Kalman update. `variance`: of the measured readout.
void ReadoutEstimator::addImage(double measured, double variance) {
  variance_ += square(readout::kDrift * model_stddev_);
  const double relative = (measured - estimate_) / std::sqrt(variance + variance_);
  // A vehicle that fills the image measures anything: beyond the limit an image counts as one at the limit.
  const double share = std::min(1.0, innovation_limit_ / std::max(std::abs(relative), 1e-9));
  scatter_ += (square(share * relative) - scatter_) / (readout::kAssumedFreedom + 1.0);
  const double gain = share * variance_ / (variance_ + std::max(1.0, scatter_) * variance);
  const double change = gain * share * (measured - estimate_);
  estimate_ += change;
  if (!known_)
    estimate_ = std::clamp(estimate_, -readout::kLongestUnknownReadout, readout::kLongestUnknownReadout);
  variance_ = std::min((1.0 - gain) * variance_ + square(readout::kMissingShare * change), prior_variance_);
}

void ReadoutEstimator::use(double estimate, bool is_shown) {
  if (known_) return;
  used_ = std::clamp(estimate, 0.0, readout::kLongestUnknownReadout);
  if (used_ < readout::kShortestReadout && is_shown) used_ = 0.0;
}

double ReadoutEstimator::stddev() const {
  return known_ ? 0.0 : std::hypot(estimate().stddev, estimate_ - used_);
}

EstimateWithStddev ReadoutEstimator::estimate() const {
  return {estimate_, std::hypot(std::sqrt(variance_), model_stddev_)};
}

bool ReadoutEstimators::choose() {
  const double before_left = left.used(), before_right = right.used();
  const bool are_shown = !areUnknown();
  const double sum = left.variance_ + right.variance_, difference = left.estimate_ - right.estimate_;
  if (!left.known_ && !right.known_ && square(difference) < square(readout::kSignificance) * sum) {
    const double common = (right.variance_ * left.estimate_ + left.variance_ * right.estimate_) / sum;
    left.use(common, are_shown);
    right.use(common, are_shown);
  } else {
    left.use(left.estimate_, !left.isUnknown());
    right.use(right.estimate_, !right.isUnknown());
  }
  return left.used() != before_left || right.used() != before_right;
}

}  // namespace cartvo::vo
