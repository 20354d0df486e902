#pragma once

#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/self_calibration_settings.hpp"

namespace cartvo::vo {

/// Errors of the right camera's rotation (rad) and of its time stamps (s).
struct RigStates {
  EstimateWithStddev pitch, yaw, roll, delay;
};

/// Errors of the rig's calibration as the windows of the tracks find them, and the part that is corrected.
class RigCalibration {
 public:
  explicit RigCalibration(const SelfCalibrationSettings& settings = {});

  /// Sets the states that a window has found; a yaw only if it is measured.
  void set(const RigStates& states);
  /// Sets the pitch (rad) that was found after a bump. Roll and yaw get the variance of a bump.
  void reinitialisePitch(const EstimateWithStddev& pitch);
  /// The yaw may be wrong by as much as after a bump.
  void openYaw();

  /// Estimates with their deviations, without what the lenses leave.
  const RigStates& states() const { return states_; }
  /// Stddev (rad) of the yaw before a window. A short way shows little of a yaw, which changes depths: it
  /// begins as in a good calibration.
  double priorYawStddev() const;
  /// Rotation of the right camera for the search for matches: the estimate, limited.
  RigCorrection expected() const;
  /// Rotation to correct: significant errors, limited.
  RigCorrection correction() const;
  RigCalibrationError error() const;

 private:
  RigCorrection limited(RigCorrection correction) const;

  SelfCalibrationSettings settings_;
  RigStates states_;
  bool yaw_is_open_ = false;  ///< by a bump, or as images have contradicted the calibration
};

}  // namespace cartvo::vo
