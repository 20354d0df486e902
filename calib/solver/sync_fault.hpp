#pragma once

#include <vector>

#include "calib/solver/board_adjustment.hpp"

namespace cartvo::calib {

/// Views in which the board moved between the exposures of the two cameras.
struct SyncDiagnosis {
  int opposed_views = 0;   ///< views whose mean left and right residuals point in opposite directions
  double max_shift = 0.0;  ///< largest difference of these means, px
  bool is_fault = false;   ///< whether there are too many of them to trust the calibration
};

/// Detects views of a moving board. Its adjusted pose is between its poses at the two exposures, so all left
/// corners have about the same residual and all right ones the opposite. A wrong rig does not cause this,
/// since the relative pose absorbs what is common to all views. `corner_stddev`: noise of the corners, px.
SyncDiagnosis diagnoseSync(const std::vector<ViewResiduals>& residuals, double corner_stddev);

}  // namespace cartvo::calib
