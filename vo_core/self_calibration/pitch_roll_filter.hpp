#pragma once

#include <optional>

#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/self_calibration/row_measurement.hpp"

namespace cartvo::vo {

/// Information filter for the right camera's pitch and roll, measured by the rows of stereo matches. It
/// estimates the delay and the cross term to keep them out of these; the delay that is published is
/// DelayFilter's. It forgets within some seconds, so that it follows a bumped camera.
class PitchRollFilter {
 public:
  PitchRollFilter();

  /// Updates with the rows of one pair, whose right pixels were corrected by `applied`. `time_step`: s since
  /// the previous pair.
  void update(const RowMeasurement& measurement, const RigCorrection& applied, double time_step);

  /// Adds a pitch (rad) that a coarse search found; restarts with its uncertainty.
  void reinitialisePitch(double pitch);

  /// Restarts with the pitch of one pair's measurement and its uncertainty.
  void reinitialisePitch(const RowMeasurement& measurement);

  /// Returns the yaw (rad) by which the right camera has turned recently, or 0, and clears it. Derived from a
  /// step of the cross term: yaw or the lens may cause it, but lenses do not change within a minute.
  double takeYawStep();

  const RowErrors::Vector& estimate() const { return estimate_; }
  /// Standard deviation from the noise of the matches and from the row errors that even a good calibration
  /// leaves.
  RowErrors::Vector stddev() const;

  /// Pitch and roll to correct, limited: zero unless they are significant and larger than the errors that
  /// every calibration leaves.
  RigCorrection correction() const;

  /// Pitch and roll for the search for matches: as correction(), with a lower significance level.
  RigCorrection expected() const;

 private:
  void reinitialisePitch(double pitch, double stddev);
  RigCorrection correctionBeyond(const RowErrors::Vector& dead_zone) const;

  RowErrors::Vector estimate_ = RowErrors::Vector::Zero();
  RowErrors::Matrix information_;
  RowErrors::Matrix sum_of_products_ = RowErrors::Matrix::Zero();  ///< of RowMeasurement::mean_products
  double pairs_ = 0.0;                                             ///< in that sum, with decay
  std::optional<double> usual_cross_term_;  ///< running mean; empty until the filter has settled
};

}  // namespace cartvo::vo
