#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/calibrate/mount/mount.hpp"

// Readout of a rolling shutter from the bands that a lamp on the mains makes in pictures.

namespace cartvo::calibrate {

/// Brightness of a picture's rows.
struct RowProfile {
  double time = 0.0;      ///< s, of the exposure
  Eigen::MatrixXd means;  ///< mean grey level: raw rows x blocks of columns
};

/// Profile of a picture (CV_8UC1) in 8 blocks of columns.
RowProfile rowProfile(const cv::Mat& image, double time);

/// A readout and how it was measured.
struct ReadoutMeasurement {
  Estimate readout;        ///< s, signed as calib::CameraModel::readout
  double bands = 0.0;      ///< number of bands across the picture
  double amplitude = 0.0;  ///< of the bands, relative to the mean brightness
  std::size_t pictures = 0;
};

/// Measures the readout from pictures of a scene at standstill, lit by a lamp whose brightness varies with
/// twice the mains frequency (Hz, 50 or 60), with a short exposure. All profiles must have the same size.
/// Throws std::runtime_error that says what to do if there are too few pictures, no bands, bands that stand
/// still or whose direction of movement cannot be observed at this frame rate, bands of the other mains
/// frequency, or bands that are too weak.
ReadoutMeasurement measureReadout(const std::vector<RowProfile>& profiles, double mains_frequency);

}  // namespace cartvo::calibrate
