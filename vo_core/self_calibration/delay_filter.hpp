#pragma once

#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/self_calibration/row_measurement.hpp"

namespace cartvo::vo {

/// Information filter for the delay of the right camera. It estimates with it what else shifts the rows of a
/// calibrated camera (RowPatterns): over a flat road at constant speed a delay shifts rows much as errors of
/// the lens and of the baseline's direction do, which would pass for a delay of some tenths of a millisecond.
/// Lens and baseline are remembered for a minute, so that changes of the speed and of the scene tell them
/// from the delay; where they do not, the stated deviation is larger.
class DelayFilter {
 public:
  DelayFilter();

  /// Updates with the rows of one pair, whose right pixels were corrected by `applied`. `time_step`: s since
  /// the previous pair.
  void update(const RowMeasurement& measurement, const RigCorrection& applied, double time_step);

  /// Forgets what was measured before the right camera was turned by `pitch` (rad); keeps the estimates.
  void restart(double pitch);

  /// Delay in s, and its standard deviation from the noise of the matches and from row patterns that even a
  /// good calibration leaves.
  EstimateWithStddev delay() const;

  const RowPatterns::Vector& estimate() const { return estimate_; }

 private:
  RowPatterns::Vector estimate_ = RowPatterns::Vector::Zero();
  RowPatterns::Matrix information_;
  RowPatterns::Matrix sum_of_products_ = RowPatterns::Matrix::Zero();  ///< of RowEquations::mean_products
  double pairs_ = 0.0;                                                 ///< in that sum, with decay
};

}  // namespace cartvo::vo
