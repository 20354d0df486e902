#pragma once

// Estimated calibration error of the rig, part of the output of StereoOdometry.

namespace cartvo::vo {

/// An estimate with its standard deviation, both in the same unit.
struct EstimateWithStddev {
  double value = 0.0;
  double stddev = 0.0;
};

/// Shares of the variances of a calibration that measurements have removed. 0: nothing was measured yet or
/// the drive does not show it, as a standing cart shows no delay; 1: measured exactly.
struct RigObservability {
  double pitch = 0.0, yaw = 0.0, roll = 0.0, delay = 0.0;
};

/// Error of the rig's calibration estimated while driving, before correction. Angles of the right camera
/// relative to the left one, rad, about the axes of the rectified right camera (x right, y down, z forward):
/// pitch is positive if it looks too far up, yaw if too far right, roll if it is turned clockwise.
struct RigCalibrationError {
  EstimateWithStddev pitch, yaw, roll;
  EstimateWithStddev delay;  ///< s, by which the right exposure is later than its timestamp
  RigObservability observability = {};
};

}  // namespace cartvo::vo
