// Prediction of the motion about the next exposure.
#include "vo_core/rolling_shutter/motion_prediction.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

/// Squared errors that a jerk causes within a time (s) over those within one second.
RowInformation::Vector growth(double time) {
  constexpr double kLeastTime = 1e-3;  // s; no cameras are that fast, but timestamps may jump
  const double square = std::pow(std::max(time, kLeastTime), 2);
  RowInformation::Vector factors;
  factors << Vector6d::Constant(square * square), Vector6d::Constant(square), Eigen::Vector3d::Ones();
  return factors;
}

}  // namespace

PredictedMotion PredictionErrors::combine(const MotionPredictions& predictions) const {
  const RowInformation::Vector errors = growth(predictions.time_step).cwiseProduct(extrapolated_);
  const RowInformation::Vector sum = mean_ + errors;
  const RowInformation::Vector share =  // of the extrapolated motion
      (sum.array() > 0.0).select(mean_.cwiseQuotient(sum), 0.0);
  return {predictions.mean + share.cwiseProduct(predictions.extrapolated - predictions.mean),
          share.cwiseProduct(errors)};
}

void PredictionErrors::update(const MotionPredictions& predictions, const ExposureMotion& found) {
  const RowInformation::Vector motion = vectorOf(found);
  mean_ = memory_ * mean_ + (1.0 - memory_) * (motion - predictions.mean).cwiseAbs2();
  extrapolated_ =
      memory_ * extrapolated_ +
      (1.0 - memory_) *
          (motion - predictions.extrapolated).cwiseAbs2().cwiseQuotient(growth(predictions.time_step));
}

}  // namespace cartvo::vo
