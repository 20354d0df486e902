#pragma once

#include <vector>

#include "calib/board_view.hpp"
#include "calib/stereo_calibration.hpp"

namespace cartvo {

/// What a calibration from the other views makes of a view.
struct HeldOutView {
  double rms = 0.0;                          ///< of corners seen to corners projected, px
  std::vector<double> vertical_disparities;  ///< px of the rectified images
};

/// How well a model foretells views that it was not solved from.
struct CrossValidation {
  std::vector<HeldOutView> views;       ///< in the order of the calibration's
  double rms = 0.0;                     ///< over all corners, px
  double vertical_disparity_rms = 0.0;  ///< px of the rectified images
  double vertical_disparity_p95 = 0.0;  ///< of the absolute value
};

/// Holds out each of `folds` parts of the views by turns, calibrates with the others, and looks at the
/// held-out ones: only the board's pose is fitted to them. Throws std::runtime_error if a model that was
/// solved from all views cannot be from a part of them.
CrossValidation crossValidate(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                              const std::vector<Eigen::Vector2d>& board_corners, int folds);

}  // namespace cartvo
