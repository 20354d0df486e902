#pragma once

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/self_calibration/delay_filter.hpp"
#include "vo_core/self_calibration/pitch_roll_filter.hpp"
#include "vo_core/self_calibration/row_measurement.hpp"
#include "vo_core/self_calibration/yaw_filter.hpp"

namespace cartvo::vo {

/// Estimates the rig's calibration error while driving: yaw and p2 from the disparities of stereo matches;
/// pitch, roll and delay from their rows.
class RigCalibrationFilter {
 public:
  /// Updates with the newest pair of an adjusted problem, whose right pixels were corrected by `applied`.
  /// `rows`: measureRows() of the problem. `time_step`: s since the previous pair.
  void update(const BundleProblem& adjusted, const BundleResult& result, const RowMeasurement& rows,
              const RigCorrection& applied, double time_step);

  /// Adds a pitch (rad) that a coarse search found; restarts the estimates from rows with its uncertainty.
  void reinitialisePitch(double pitch) {
    rows_.reinitialisePitch(pitch);
    delay_.restart(pitch);
  }

  /// Restarts with the pitch measured from the rows of one pair's uncorrected stereo matches
  /// (buildNewestPairProblem()).
  void reinitialisePitch(const BundleProblem& matches);

  /// Rotation and p2 to correct: only significant errors.
  RigCorrection correction() const;

  /// Rotation of the right camera for the search for matches: as correction(), but with a lower significance
  /// level. Without p2.
  RigCorrection expected() const;

  RigCalibrationError error() const;

 private:
  YawFilter columns_;
  PitchRollFilter rows_;
  DelayFilter delay_;
};

}  // namespace cartvo::vo
