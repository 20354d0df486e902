#pragma once

#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/estimation/motion_error.hpp"
#include "vo_core/tracking/window_frame.hpp"

// Covariances of the poses and of the last motion of an adjusted window.

namespace cartvo::vo {

/// Uncertainty of a pair that its landmarks' residuals do not show.
struct PairInflation {
  double overlap = 1.0;  ///< factor on the covariance by landmarks, see PatchOverlap
  /// Factor on the covariance of poses, see CodecErrorModel.
  double pose_noise_inflation = 1.0;
  double offset_stddev = 0.0;  ///< s, of the time offset
};

/// Updates covariances and time offset errors of the adjusted pairs of a window, whose poses were copied from
/// `problem`. `inflation` is that of the newest pair. Returns the errors of the motion between the last two
/// pairs by landmarks, scale and offset, and its inflation by the codec.
MotionError updateUncertainties(const BundleProblem& problem, const BundleResult& result,
                                const PairInflation& inflation, const UncertaintySettings& settings,
                                std::vector<WindowFrame>& window);

/// Covariance of a pair's pose relative to the first one, including the error due to the time offset.
Matrix6d poseCovarianceOf(const WindowFrame& frame);

}  // namespace cartvo::vo
