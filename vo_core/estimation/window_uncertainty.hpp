#pragma once

#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/tracking/window_frame.hpp"

// Covariances of the poses and of the last motion of an adjusted window.

namespace cartvo::vo {

/// Covariance of the motion between the last two pairs of a window, split by cause; perturbations on the
/// right.
struct MotionUncertainty {
  Matrix6d by_landmarks = Matrix6d::Zero();  ///< noise of both poses relative to the landmarks
  /// Error of the window's scale. Fixed poses and landmark depths share that scale, so a motion that agrees
  /// with them has the same scale error.
  Matrix6d by_scale = Matrix6d::Zero();
  Vector6d offset_error = Vector6d::Zero();  ///< error of the motion for one stddev of the time offset

  Matrix6d byOffset() const { return offset_error * offset_error.transpose(); }
};

/// Uncertainty of a pair that its landmarks' residuals do not show.
struct PairInflation {
  double overlap = 1.0;  ///< factor on the covariance by landmarks, see PatchOverlap
  /// Factor on the covariance of poses, see CodecErrorModel. MotionUncertainty does not include it.
  double pose_noise_inflation = 1.0;
  double offset_stddev = 0.0;  ///< s, of the time offset
};

/// Updates covariances and time offset errors of the adjusted pairs of a window, whose poses were copied from
/// `problem`. `inflation` is that of the newest pair.
MotionUncertainty updateUncertainties(const BundleProblem& problem, const BundleResult& result,
                                      const PairInflation& inflation, std::vector<WindowFrame>& window);

/// Covariance of a pair's pose relative to the first one, including the error due to the time offset.
Matrix6d poseCovarianceOf(const WindowFrame& frame);

}  // namespace cartvo::vo
