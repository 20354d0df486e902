#pragma once

namespace cartvo::vo {

/// Self-calibration of the rig (RigCalibrationFilter). Angles in rad; lens coefficients and the baseline's
/// direction in normalised coordinates.
struct SelfCalibrationSettings {
  // Standard deviations of what is not yet measured.
  /// Error of a rotation, of each lens coefficient and of the baseline's direction after a calibration, and
  /// error that a bump adds to a rotation.
  double calibration_stddev = 3e-3;
  double skew_stddev = 1e-2;       ///< row pattern x y of the lenses: KITTI's rectified images have 9e-3
  double delay_stddev = 1e-2;      ///< s, of timestamps
  double readout_stddev = 4.8e-3;  ///< s, of a stated readout: 15 % of that of usual sensors

  // Process noise: standard deviation after 1 s; it grows with the square root of time.
  double rotation_drift = 2e-6;  ///< also of lens coefficients
  double skew_drift = 3e-4;      ///< the pattern also contains what depends on the scene
  double delay_drift = 5e-5;     ///< s: clocks that differ by 50 ppm

  // Measurements.
  double correlated_pairs = 10.0;  ///< that share the errors of their landmarks, which last about as long
  double row_noise = 0.02;         ///< px, least standard deviation of the row of a match
  double row_robust_width = 2.0;   ///< standard deviations of a residual that halve its weight
  double rate_stddev = 0.02;  ///< rad/s, of the rotation from left to right exposure that poses do not show
  double unknown_rate_stddev = 0.3;  ///< the same of a single pair: 3 m/s past a point 10 m away
  double window_path = 0.5;          ///< m; a shorter window does not determine the yaw

  // Errors of the model, which do not average out.
  double row_pattern = 0.03;           ///< px rms, row pattern of a good calibration that is not estimated
  double pattern_memory = 10.0;        ///< s, over which the sensitivity to it is averaged
  double yaw_pattern_stddev = 2e-4;    ///< what the lenses leave that resembles a yaw
  double uncorrected_yaw_share = 4.0;  ///< error of a yaw beyond the limit per rad: depths are then wrong
  double readout_model_stddev = 8e-4;  ///< s, error of a readout by those of depths and poses

  // Innovation test: a component whose changes have a mean beyond the predicted one has been bumped.
  double innovation_limit = 5.0;  ///< standard deviations of one change; larger ones are reduced to it
  double bump_innovation = 0.5;   ///< standard deviations of the mean change over correlated_pairs

  // Correction.
  double maximum_rotation = 1e-2;  ///< more requires a new calibration
  double maximum_p2 = 3e-3;        ///< the same
};

}  // namespace cartvo::vo
