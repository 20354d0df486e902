#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/solver/calibration.hpp"

namespace cartvo {

// Plots of a calibration. All but the last are SVG elements.

/// Corners in one camera's images, coloured by their residual.
std::string coveragePlot(const Calibration& calibration, std::vector<SeenCorner> BoardView::*side,
                         std::vector<Eigen::Vector2d> ViewResiduals::*residuals);

/// RMS residuals of each view, left and right, and its error when held out.
std::string residualPlot(const Calibration& calibration);

/// Depth error over distance: from the vertical disparity's RMS and from the difference of the two halves.
std::string depthPlot(const Calibration& calibration);

/// Both rectified images side by side, with lines along the rows (CV_8UC3).
cv::Mat rectifiedPair(const Calibration& calibration, const cv::Mat& left, const cv::Mat& right);

}  // namespace cartvo
