#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/calibration.hpp"

namespace cartvo {

/// A raw pair (CV_8UC1) to show rectified; empty images if there is none.
struct ReportPair {
  std::string name;
  cv::Mat left, right;
};

/// One HTML page that needs nothing but itself: where corners were seen, residuals by view, a rectified pair
/// with lines along its rows, uncertainties, depth error against distance, models tried, rejected views.
std::string calibrationReport(const Calibration& calibration, const ReportPair& pair);

}  // namespace cartvo
