#pragma once

#include <Eigen/Core>

#include "vo_core/window/window_problem.hpp"

// Residuals of an observation, each coordinate at the instant of its own row, and their derivatives.

namespace cartvo::vo {

/// States that an observation depends on: of each camera at the instant of its row, and what is shared, which
/// has the order of SharedState. Positions are in the world's axes, turns on the right. Groups of four
/// (DoubleLanes) have gaps, and end with the residuals, so that gradients are summed like information.
enum ObservationState : int {
  kRowLeftPosition = 0,
  kRowLeftReadout = 3,
  kRowLeftTurn = 4,
  kRowRightPosition = 8,
  kRowRightTurn = 12,
  kRowRightReadout = 16,
  kRowOffset = 17,
  kRowRig = 18,
  kRowResidual = kRowRig + kRigStates,
  kObservationStates
};

/// Both cameras of a pair at the instants in the middle of a band of rows.
struct WindowBand {
  double left_time = 0.0, right_time = 0.0;  ///< s
  Trajectory::Instant left, right;           ///< of the left camera of the rig, at either time
};

/// Residuals (px, measured minus predicted) in the order left x, y, right x, y, and their derivatives. Of the
/// right ones, the part that the left ones have in common with them is taken off. Those of an image without a
/// position are zero and have no weight.
struct ObservationEquations {
  Eigen::Vector4d precision;  ///< 1/px^2, inverse square of the scales
  /// Of the prediction by ObservationState, and the residuals.
  Eigen::Matrix<double, 4, kObservationStates, Eigen::RowMajor> by_state;
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> by_place;  ///< of the prediction, by WindowLandmark::place

  auto residual() const { return by_state.col(kRowResidual); }
  /// Square of the residuals over their scales in one image. `image`: 0 left, 1 right.
  double squareIn(int image) const {
    return (residual().array().square() * precision.array()).segment<2>(2 * image).sum();
  }
};

/// Sets the equations of an observation whose rows are near the middle of `band`: the camera accelerates
/// uniformly between them. `scale`: factor on the noise. False if the landmark is not in front of both
/// cameras.
bool setEquations(const WindowProblem& problem, const WindowBand& band, const WindowLandmark& landmark,
                  const WindowObservation& observation, double scale, ObservationEquations& equations);

/// Degrees of freedom of the noise's t distribution.
constexpr double kWindowFreedom = 5.0;

/// Weight of an image's position in the iteratively re-weighted normal equations of Student's t distribution
/// in two dimensions (K. Lange et al., "Robust statistical modeling using the t distribution", 1989).
/// `square`: of the residuals over their scales.
inline double studentWeight(double square) {
  return (kWindowFreedom + 2.0) / (kWindowFreedom + square);
}

/// Information of a position with that distribution over that of the mean weight, which is 1 (same source,
/// appendix B).
constexpr double kStudentInformation = (kWindowFreedom + 2.0) / (kWindowFreedom + 4.0);

}  // namespace cartvo::vo
