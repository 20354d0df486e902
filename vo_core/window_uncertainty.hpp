#pragma once

#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_tracker.hpp"

namespace cartvo {

/// Of the motion from the last pair but one to the last pair of a window, by what makes it err; covariances
/// of perturbations on the right.
struct MotionUncertainty {
  Matrix6d by_landmarks = Matrix6d::Zero();  ///< by the noise of both poses against the landmarks
  /// What a wrong scale of the window adds. The window's older poses stand and its landmarks keep their
  /// depths, all in that scale: a motion that agrees with them to the last tenth of a millimetre is wrong
  /// with them.
  Matrix6d by_scale = Matrix6d::Zero();
  Vector6d offset_error = Vector6d::Zero();  ///< what one standard deviation of the offset makes of it

  Matrix6d byOffset() const { return offset_error * offset_error.transpose(); }
};

/// What a pair is known to err by beyond the residuals of its landmarks.
struct PairDoubts {
  double overlap = 1.0;  ///< times the variance by landmarks: PatchOverlap
  double excess = 1.0;   ///< times the variance of poses: VideoErrors; MotionUncertainty is without it
  double offset_deviation = 0.0;  ///< s
};

/// Gives the adjusted pairs of a window, whose poses have been taken over from `problem`, their covariances
/// and the errors that an uncertain offset makes of them. `doubts`: of the newest pair.
MotionUncertainty takeUncertainties(const BundleProblem& problem, const BundleResult& result,
                                    const PairDoubts& doubts, std::vector<WindowFrame>& window);

/// Of a pair's pose against the first one, with what the offset's error has added up to.
Matrix6d poseCovarianceOf(const WindowFrame& frame);

}  // namespace cartvo
