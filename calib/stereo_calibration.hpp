#pragma once

#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board_adjustment.hpp"
#include "calib/board_view.hpp"
#include "calib/calibration_model.hpp"

namespace cartvo {

/// One of the rig's numbers and how well the views determine it.
struct ParameterEstimate {
  ParameterName name;
  double value = 0.0;
  double deviation = 0.0;  ///< standard deviation, from the corners' scatter
};

/// A rig solved from views of a board.
struct StereoCalibration {
  CalibrationModel model = CalibrationModel::brown5;
  RigAndBoards estimate;                      ///< boards in the order of the views
  double corner_deviation = 0.0;              ///< robust standard deviation of a corner in each direction, px
  std::vector<ParameterEstimate> parameters;  ///< the free ones
};

/// Both cameras and their relative pose from views alone, under models of one lens, from few parameters to
/// many, each from the one before: a start, then all that the model leaves free, jointly and robustly, the
/// scale of the residuals' weights following their scatter. Throws std::runtime_error if a model cannot
/// describe the views, saying why.
std::vector<StereoCalibration> calibrateStereo(const std::vector<BoardView>& views,
                                               const std::vector<Eigen::Vector2d>& board_corners,
                                               cv::Size image_size,
                                               const std::vector<CalibrationModel>& models);

/// One model from a known start, whose boards are those of `views`.
StereoCalibration calibrateStereoFrom(const RigAndBoards& start, const std::vector<BoardView>& views,
                                      const std::vector<Eigen::Vector2d>& board_corners,
                                      CalibrationModel model);

/// A view that is not used, and why, for people.
struct RejectedView {
  std::string name;
  std::string reason;
};

/// Views without what does not fit, and what that was.
struct CleanedViews {
  std::vector<BoardView> views;
  std::vector<RejectedView> rejected;
  std::size_t rejected_corners = 0;  ///< of the views that are kept
};

/// Takes out corners more than five standard deviations off, and views whose corners lie three times as far
/// off as the median view's, or of which too little is left.
CleanedViews withoutOutliers(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                             const std::vector<Eigen::Vector2d>& board_corners);

/// The root of the mean squared distance between seen and projected corners of both cameras, px.
double residualRms(const ViewResiduals& residuals);

}  // namespace cartvo
