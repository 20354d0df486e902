// Estimates a readout by a filter; the scatter of the images tells how far they can be trusted.
#include "vo_core/self_calibration/readout_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

// s; no sensor of a camera reads its rows that fast: a shorter readout is that of a global shutter.
constexpr double kShortestReadout = 5e-3;
// s; none that is not stated is longer: 30 pictures a second leave no more time.
constexpr double kLongestReadout = 45e-3;
// Images whose motions are made from common poses, so that they share errors: the poses of a polynomial.
constexpr double kSharingImages = 5.0;
// Images that the assumed scatter counts as, and over which it is averaged.
constexpr double kAssumedFreedom = 50.0;
// Random walk of a readout from image to image, in standard deviations of the model.
constexpr double kDrift = 0.02;
// Part of a change by which it may be too small: poses follow rows that are timed wrongly.
constexpr double kMissingShare = 0.4;

double square(double value) {
  return value * value;
}

}  // namespace

ReadoutEstimator::ReadoutEstimator(const Shutter& shutter, const SelfCalibrationSettings& settings)
    : known_(shutter.readout_stddev == 0.0),
      model_stddev_(settings.readout_model_stddev),
      used_(shutter.readout),
      estimate_(shutter.readout),
      variance_(square(known_ ? settings.readout_stddev : shutter.readout_stddev)) {}

bool ReadoutEstimator::update(const ReadoutEquation& equation) {
  if (!(equation.information > 0.0) || !std::isfinite(equation.gradient)) return false;
  addImage(used_ + equation.gradient / equation.information, kSharingImages / equation.information);
  // With each change all rows are timed anew, and what they told of the motion is lost.
  if (known_ || (!isUnknown() && std::abs(estimate_ - used_) < stddev())) return false;
  const double before = used_;
  used_ = std::clamp(estimate_, 0.0, kLongestReadout);
  if (used_ < kShortestReadout) used_ = 0.0;
  return used_ != before;
}

/// Kalman update. `variance`: of the measured readout.
void ReadoutEstimator::addImage(double measured, double variance) {
  variance_ += square(kDrift * model_stddev_);
  const double innovation = measured - estimate_;
  scatter_ += (square(innovation) / (variance + variance_) - scatter_) / (kAssumedFreedom + 1.0);
  const double gain = variance_ / (variance_ + std::max(1.0, scatter_) * variance);
  const double change = gain * innovation;
  estimate_ += change;
  variance_ = (1.0 - gain) * variance_ + square(kMissingShare * change);
}

EstimateWithStddev ReadoutEstimator::estimate() const {
  return {estimate_, std::hypot(std::sqrt(variance_), model_stddev_)};
}

}  // namespace cartvo::vo
