#pragma once

namespace cartvo::vo {

/// Self-calibration of the rig. Angles in rad; lens coefficients in normalised coordinates.
struct SelfCalibrationSettings {
  // Standard deviations of what is not yet measured.
  double calibration_stddev = 3e-3;  ///< error of a rotation after a calibration, and by a bump
  double skew_stddev = 1e-2;         ///< row pattern x y of the lenses: KITTI's rectified images have 9e-3
  double delay_stddev = 1e-2;        ///< s, of timestamps
  double readout_stddev = 5e-4;      ///< s, of a stated readout, as a lamp shows it

  // Process noise: standard deviation after 1 s; it grows with the square root of time.
  double rotation_drift = 2e-6;  ///< also of lens coefficients
  double delay_drift = 5e-5;     ///< s: clocks that differ by 50 ppm

  // Measurements.
  double correlated_pairs = 10.0;  ///< memory of running means: landmarks last about as long
  double rate_stddev = 0.02;  ///< rad/s, of the rotation from left to right exposure that poses do not show
  double unknown_rate_stddev = 0.3;  ///< the same of a single pair: 3 m/s past a point 10 m away

  // Errors of the model, which do not average out.
  double yaw_pattern_stddev = 2e-4;    ///< of the lenses, that resembles a yaw; stddev of p2
  double uncorrected_yaw_share = 4.0;  ///< error of a yaw beyond the limit per rad: depths are then wrong

  // Correction.
  double maximum_rotation = 3.5e-2;  ///< 2 degrees: more requires a new calibration
};

}  // namespace cartvo::vo
