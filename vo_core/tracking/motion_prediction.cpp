// Prediction of the motion about the next exposure.
#include "vo_core/tracking/motion_prediction.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

/// Squared errors that a jerk causes within a time (s) over those within one second.
MotionComponents growth(double time) {
  constexpr double kLeastTime = 1e-3;  // s; no cameras are that fast, but timestamps may jump
  const double square = std::pow(std::max(time, kLeastTime), 2);
  MotionComponents factors;
  factors << Vector6d::Constant(square * square), Vector6d::Constant(square), Eigen::Vector3d::Ones();
  return factors;
}

}  // namespace

PredictedMotion PredictionErrors::combine(const MotionPredictions& predictions) const {
  const MotionComponents errors = growth(predictions.time_step).cwiseProduct(extrapolated_);
  const MotionComponents sum = mean_ + errors;
  const MotionComponents share =  // of the extrapolated motion
      (sum.array() > 0.0).select(mean_.cwiseQuotient(sum), 0.0);
  return {predictions.mean + share.cwiseProduct(predictions.extrapolated - predictions.mean),
          share.cwiseProduct(errors)};
}

void PredictionErrors::update(const MotionPredictions& predictions, const ExposureMotion& found) {
  const MotionComponents motion = componentsOf(found);
  mean_ = memory_ * mean_ + (1.0 - memory_) * (motion - predictions.mean).cwiseAbs2();
  extrapolated_ =
      memory_ * extrapolated_ +
      (1.0 - memory_) *
          (motion - predictions.extrapolated).cwiseAbs2().cwiseQuotient(growth(predictions.time_step));
}

}  // namespace cartvo::vo
