#pragma once

#include "vo_core/geometry/exposure_motion.hpp"

namespace cartvo::vo {

/// A motion about an exposure and the variances of its error, in the order of RowInformation.
struct PredictedMotion {
  RowInformation::Vector motion = RowInformation::Vector::Zero(), variances = RowInformation::Vector::Zero();
};

/// Two predictions of the motion about the next exposure: that about the last one with a constant
/// acceleration, and the mean velocity of the window.
struct MotionPredictions {
  RowInformation::Vector extrapolated = RowInformation::Vector::Zero(), mean = RowInformation::Vector::Zero();
};

/// Mean squared errors of both predictions over the last pairs. A vibration that is faster than the pairs
/// contradicts the extrapolation, a turn the mean.
class PredictionErrors {
 public:
  /// `pairs`: half of a mean is older than about 0.7 times as many.
  explicit PredictionErrors(double pairs) : memory_(1.0 - 1.0 / pairs) {}

  /// The weighted mean of both, each component by the inverse variances of its errors.
  PredictedMotion combine(const MotionPredictions& predictions) const;

  /// Updates with the predictions of a motion and the motion found.
  void update(const MotionPredictions& predictions, const ExposureMotion& found);

 private:
  double memory_;  ///< weight of the previous pairs, per pair
  MotionPredictions squares_;
};

}  // namespace cartvo::vo
