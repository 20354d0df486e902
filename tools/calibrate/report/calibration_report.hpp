#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/solver/calibration.hpp"

namespace cartvo {

/// A raw pair (CV_8UC1) to show rectified in the report; empty images if there is none.
struct ReportPair {
  std::string name;
  cv::Mat left, right;
};

/// A self-contained HTML page: checks, image coverage, residuals by view, a rectified pair with lines along
/// its rows, depth error over distance, models compared, uncertainties, rejected views. `origin`: date,
/// version, source and rig file, for people.
std::string calibrationReport(const calib::Calibration& calibration, const std::string& origin,
                              const ReportPair& pair);

}  // namespace cartvo
