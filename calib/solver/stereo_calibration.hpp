#pragma once

#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board/board_view.hpp"
#include "calib/model/rig.hpp"
#include "calib/solver/board_adjustment.hpp"

// Calibration of a stereo rig from views of a board, for given lens models.

namespace cartvo::calib {

/// Computes a first estimate of a rig from views alone, to start the adjustment from. Each camera's focal
/// length is the one of a range that fits the corners to a flat board best, and is then adjusted together
/// with two distortion coefficients. The relative pose is that of the view that agrees best with the others.
/// Throws std::runtime_error if no focal length fits.
RigAndBoards initialCalibration(const std::vector<BoardView>& views,
                                const std::vector<Eigen::Vector2d>& board_corners, cv::Size image_size,
                                LensModel lens);

/// Estimates T_left_board for a known rig: the pose from the camera that sees more corners, adjusted to both
/// cameras. std::nullopt if it cannot be computed.
std::optional<Eigen::Isometry3d> fitBoardPose(const Rig& rig, const BoardView& view,
                                              const std::vector<Eigen::Vector2d>& board_corners,
                                              double robust_scale);

/// Robust standard deviation of the residuals per direction, px: from their median norm, for normal noise
/// with outliers.
double robustStddev(const std::vector<ViewResiduals>& residuals);

/// One of the rig's parameters and its uncertainty.
struct ParameterEstimate {
  ParameterName name;
  double value = 0.0;
  double stddev = 0.0;  ///< from the corners' noise
};

/// A rig estimated from views of a board.
struct StereoCalibration {
  CalibrationModel model = CalibrationModel::brown5;
  RigAndBoards estimate;                      ///< with the boards in the order of the views
  double corner_stddev = 0.0;                 ///< robust standard deviation of a corner per direction, px
  std::vector<ParameterEstimate> parameters;  ///< the free parameters
};

/// Calibrates both cameras and their relative pose under several models of one lens, ordered by their number
/// of parameters. The first starts from initialCalibration, each further one from the one before. All free
/// parameters are estimated jointly and robustly; the scale of the robust weights follows the noise of the
/// residuals. Throws std::runtime_error with the reason if a model cannot be fitted.
std::vector<StereoCalibration> calibrateStereo(const std::vector<BoardView>& views,
                                               const std::vector<Eigen::Vector2d>& board_corners,
                                               cv::Size image_size,
                                               const std::vector<CalibrationModel>& models);

/// Calibrates one model from a known start, whose boards are those of `views`.
StereoCalibration calibrateStereoFrom(const RigAndBoards& start, const std::vector<BoardView>& views,
                                      const std::vector<Eigen::Vector2d>& board_corners,
                                      CalibrationModel model);

/// A view that is not used, and the reason, for display.
struct RejectedView {
  std::string name;
  std::string reason;
};

/// Views without outliers, and what was rejected.
struct CleanedViews {
  std::vector<BoardView> views;
  std::vector<RejectedView> rejected;
  std::size_t rejected_corners = 0;  ///< in the views that are kept
};

/// Rejects corners with residuals above five standard deviations, and views that lose more than 30 % of their
/// corners this way and have an RMS above three times that of the median view.
CleanedViews rejectOutliers(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                            const std::vector<Eigen::Vector2d>& board_corners);

/// RMS reprojection residual over the corners of both cameras, px.
double residualRms(const ViewResiduals& residuals);

}  // namespace cartvo::calib
