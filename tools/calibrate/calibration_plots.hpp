#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/calibration.hpp"

namespace cartvo {

// Plots of a calibration as SVG elements.

/// Where one camera saw corners, coloured by how far each lies from where the rig puts it.
std::string coveragePlot(const Calibration& calibration, std::vector<SeenCorner> BoardView::*side,
                         std::vector<Eigen::Vector2d> ViewResiduals::*residuals);

/// Each view's residuals, left and right, and its error when it was held out.
std::string residualPlot(const Calibration& calibration);

/// Depth error against distance: from the rows' error and from the difference of two halves.
std::string depthPlot(const Calibration& calibration);

/// Both rectified images side by side with lines along the rows (CV_8UC3).
cv::Mat rectifiedPair(const Calibration& calibration, const cv::Mat& left, const cv::Mat& right);

}  // namespace cartvo
