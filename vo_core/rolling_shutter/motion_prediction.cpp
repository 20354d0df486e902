// Prediction of the motion about the next exposure.
#include "vo_core/rolling_shutter/motion_prediction.hpp"

namespace cartvo::vo {

PredictedMotion PredictionErrors::combine(const MotionPredictions& predictions) const {
  const RowInformation::Vector sum = (squares_.mean + squares_.extrapolated).cwiseMax(1e-12);
  const RowInformation::Vector share = squares_.mean.cwiseQuotient(sum);  // of the extrapolated motion
  return {predictions.mean + share.cwiseProduct(predictions.extrapolated - predictions.mean),
          share.cwiseProduct(squares_.extrapolated)};
}

void PredictionErrors::update(const MotionPredictions& predictions, const ExposureMotion& found) {
  const RowInformation::Vector motion = vectorOf(found);
  const auto average = [&](const RowInformation::Vector& prediction, RowInformation::Vector& square) {
    square = memory_ * square + (1.0 - memory_) * (motion - prediction).cwiseAbs2();
  };
  average(predictions.extrapolated, squares_.extrapolated);
  average(predictions.mean, squares_.mean);
}

}  // namespace cartvo::vo
