#pragma once

#include "vo_core/geometry/exposure_motion.hpp"

namespace cartvo::vo {

/// A motion about an exposure and the variances of its error: m, rad and s, in the order of MotionComponents.
struct PredictedMotion {
  MotionComponents motion = MotionComponents::Zero(), variances = MotionComponents::Zero();
};

/// Two predictions of the motion about the next exposure, in the order of MotionComponents.
struct MotionPredictions {
  double time_step = 0.0;  ///< s since the last motion
  /// The last motion with a constant acceleration, and the mean velocity of the window.
  MotionComponents extrapolated = MotionComponents::Zero(), mean = MotionComponents::Zero();
};

/// Mean squared errors of both predictions over the last pairs. A vibration that is faster than the pairs
/// contradicts the extrapolation, a turn the mean.
class PredictionErrors {
 public:
  /// `pairs`: memory of the means; the last 0.7 `pairs` motions have half of the weight.
  explicit PredictionErrors(double pairs) : memory_(1.0 - 1.0 / pairs) {}

  /// The weighted mean of both, each component by the inverse variances of its errors, which are taken as
  /// independent.
  PredictedMotion combine(const MotionPredictions& predictions) const;

  /// Updates with the predictions of a motion and the motion found. The first motion of a track is compared
  /// with none: its size is what the second prediction may be wrong by.
  void update(const MotionPredictions& predictions, const ExposureMotion& found);

 private:
  double memory_;  ///< weight of the previous pairs, per pair
  /// Squared errors of the mean, and of the extrapolation over one second: its errors are those of a jerk.
  MotionComponents mean_ = MotionComponents::Zero(), extrapolated_ = MotionComponents::Zero();
};

}  // namespace cartvo::vo
