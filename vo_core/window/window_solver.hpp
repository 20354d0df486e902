#pragma once

#include <span>
#include <vector>

#include "vo_core/odometry_estimate.hpp"
#include "vo_core/window/window_equations.hpp"
#include "vo_core/window/window_problem.hpp"

// Maximum likelihood of a window.

namespace cartvo::vo {

/// Result besides the problem's own values.
struct WindowResult {
  bool converged = false;
  Eigen::MatrixXd covariance;  ///< of the unknowns, in the order of WindowPrior
  WindowNoises noise;          ///< of most likelihood given the last residuals
  WindowJerkSums jerk;         ///< of the newest intervals, over the problem's rms
};

/// Gauss-Newton with Student-t weights on all unknowns of a window with its prior.
class WindowSolver {
 public:
  /// One step for each of `scales`: factors on the noise, larger ones where the first values are far off.
  /// False if the geometry is degenerate. `noise_sums`: those of the last step, if wanted.
  bool step(WindowProblem& problem, std::span<const double> scales, WindowNoiseSums* noise_sums = nullptr);
  /// Such steps, with what follows from the last one's equations.
  WindowResult solve(WindowProblem& problem, std::span<const double> scales);

  /// Of the last step.
  const LandmarkFit& fit(std::size_t landmark) const { return equations_.fit(landmark); }
  /// Whether the values before the last step explain at least half of the problem's landmarks; elsewhere
  /// Gauss-Newton has left the minimum, and the covariance means nothing.
  bool explains(const WindowProblem& problem) const;

  /// Moves the information of landmarks that are no longer seen, and the oldest `knots` of the trajectory,
  /// into the prior. Landmarks beyond the gate are dropped.
  void marginalise(WindowProblem& problem, const std::vector<WindowLandmark>& ended, int knots);

 private:
  WindowEquations equations_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// Ties the prior to a pose (m and rad; position in the world's axes, rotation on the right) of the
/// trajectory at `time` (s), and the first knots to no velocity, with these deviations (m/s and rad/s), and
/// to an acceleration that carts have.
void tieToStart(double time, const Eigen::Isometry3d& pose, const Matrix6d& covariance,
                const Vector6d& velocity_stddev, WindowProblem& problem);

/// Of the trajectory at an instant, with covariance by that of the unknowns.
struct WindowMotion {
  Eigen::Isometry3d value;
  Matrix6d covariance;  ///< perturbations on the right
};
WindowMotion poseAt(const WindowProblem& problem, const WindowResult& result, double time);
WindowMotion motionBetween(const WindowProblem& problem, const WindowResult& result, double from, double to);
ExposureTwist twistAt(const WindowProblem& problem, const WindowResult& result, double time);

}  // namespace cartvo::vo
