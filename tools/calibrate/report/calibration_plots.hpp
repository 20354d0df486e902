#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/solver/calibration.hpp"

namespace cartvo {

// Plots of a calibration. All but the last are SVG elements.

/// Corners in one camera's images, coloured by their residual.
std::string coveragePlot(const calib::Calibration& calibration,
                         std::vector<calib::SeenCorner> calib::BoardView::*side,
                         std::vector<Eigen::Vector2d> calib::ViewResiduals::*residuals);

/// RMS residuals of each view, left and right, and its error when held out.
std::string residualPlot(const calib::Calibration& calibration);

/// Depth error over distance: from the vertical disparity's RMS and from the difference of the two halves.
std::string depthPlot(const calib::Calibration& calibration);

/// Both rectified images side by side, with lines along the rows (CV_8UC3).
cv::Mat rectifiedPair(const calib::Calibration& calibration, const cv::Mat& left, const cv::Mat& right);

}  // namespace cartvo
