#pragma once

#include <vector>

#include "calib/board_adjustment.hpp"

namespace cartvo {

/// How many views look as if the cameras had seen the board at different instants while it moved.
struct SyncDiagnosis {
  int opposed_views = 0;       ///< whose left and right residuals point opposite ways
  double largest_shift = 0.0;  ///< between the cameras, px
  bool is_fault = false;       ///< so many that the calibration is not to be trusted
};

/// A board that moved between the two exposures is put between where each camera saw it: all of the left
/// corners lie off by about the same, and the right ones by the opposite. A wrong rig does not do this: what
/// is common to all views goes into the relative pose. Scatter of `corner_deviation` (px) is allowed for.
SyncDiagnosis diagnoseSync(const std::vector<ViewResiduals>& residuals, double corner_deviation);

}  // namespace cartvo
