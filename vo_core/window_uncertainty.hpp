#pragma once

#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_tracker.hpp"

namespace cartvo {

/// Of the motion from the last pair but one to the last pair of a window; perturbation on the right.
struct MotionUncertainty {
  Matrix6d covariance = Matrix6d::Zero();
  /// What a wrong scale of the window adds. The window's older poses stand and its landmarks keep their
  /// depths, all in that scale: a motion that agrees with them to the last tenth of a millimetre is wrong
  /// with them.
  Matrix6d by_scale = Matrix6d::Zero();
  /// What one standard deviation of the offset makes of it; in the covariance too.
  Vector6d offset_error = Vector6d::Zero();
};

/// Gives the adjusted pairs of a window, whose poses have been taken over from `problem`, their covariances
/// and the errors that an uncertain offset makes of them. `excess`: how many times as large a pose's variance
/// is as if landmarks erred independently (PatchOverlap, VideoErrors). `offset_deviation`: s, of the newest
/// pair.
MotionUncertainty takeUncertainties(const BundleProblem& problem, const BundleResult& result, double excess,
                                    double offset_deviation, std::vector<WindowFrame>& window);

/// Of a pair's pose against the first one, with what the offset's error has added up to.
Matrix6d poseCovarianceOf(const WindowFrame& frame);

}  // namespace cartvo
