#pragma once

#include <vector>

#include "calib/board/board_view.hpp"
#include "calib/solver/stereo_calibration.hpp"

// Cross-validation of a calibration on held-out views.

namespace cartvo::calib {

/// Errors of a view under a calibration from the other views.
struct HeldOutView {
  double rms = 0.0;                          ///< reprojection error, px
  std::vector<double> vertical_disparities;  ///< px of the rectified images
};

/// Errors of a model on views that were held out.
struct CrossValidation {
  std::vector<HeldOutView> views;       ///< in the order of the calibration's views
  double rms = 0.0;                     ///< over all corners, px
  double vertical_disparity_rms = 0.0;  ///< px of the rectified images
  double vertical_disparity_p95 = 0.0;  ///< 95th percentile of the absolute value, px
};

/// Cross-validates a calibration: holds out each of `folds` parts of the views in turn, calibrates with the
/// others, and evaluates the held-out views, to which only the board's pose is fitted. Throws
/// std::runtime_error if the model cannot be fitted to a part of the views.
CrossValidation crossValidate(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                              const std::vector<Eigen::Vector2d>& board_corners, int folds);

}  // namespace cartvo::calib
