#pragma once

#include <optional>

#include "capture/clock/stereo_timestamper.hpp"
#include "vo_core/rig_calibration_error.hpp"

namespace cartvo::pipeline {

/// Estimates the time offset (right exposure minus left) relative to the minimum-delay arrival times from the
/// images: the correction already applied to the timestamps plus the residual offset that the odometry
/// estimates. The offset shows in the right image whenever the cart moves: forward motion and bumps suffice,
/// not only turns. Not thread-safe.
class VisualOffsetEstimator {
 public:
  /// Adds a processed pair. `rig`: its rig calibration errors, empty while unknown. `applied_correction_ns`:
  /// PairResult::appliedCorrectionNs(). `time_step`: s since the previous pair. Returns the latest estimate;
  /// at a standstill its standard deviation grows with time.
  std::optional<capture::OffsetEstimate> update(const std::optional<vo::RigCalibrationError>& rig,
                                                double applied_correction_ns, double time_step);

 private:
  double applied_correction_ns_ = 0.0;  ///< mean with the time constant of the odometry's offset estimate
  double weight_ = 0.0;                 ///< of that mean, s
  std::optional<capture::OffsetEstimate> estimate_;
};

}  // namespace cartvo::pipeline
