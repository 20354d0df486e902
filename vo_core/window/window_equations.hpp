#pragma once

#include <Eigen/Core>
#include <vector>

#include "vo_core/window/observation_equations.hpp"
#include "vo_core/window/window_problem.hpp"

// Normal equations of a window: landmarks are eliminated, each trajectory's knots and the shared states stay.

namespace cartvo::vo {

/// Weighted residuals of a window, from which its noise follows.
class WindowNoiseSums {
 public:
  /// `covariance`: of the landmark's place given all poses.
  void add(int level, const ObservationEquations& equations, const Eigen::Matrix3d& covariance);
  /// Noise of most likelihood, that of `before` where residuals are few. `before`: with which they were made.
  WindowNoises concluded(const WindowNoises& before) const;

 private:
  struct Sum {
    double squares = 0.0, freedom = 0.0;
  };
  struct Level {
    Sum left, right;
    double common = 0.0, by_left = 0.0;  ///< products of right with left residuals, and squares of the latter
  };
  std::array<Level, kLandmarkLevels> levels_{};
};

/// Normal equations about the problem's values. Unknowns as WindowPrior's.
class WindowEquations {
 public:
  /// Equations of observations, with the landmarks eliminated (Schur complement of 3 x 3 blocks; B. Triggs et
  /// al., "Bundle adjustment - a modern synthesis", 2000). `gated`: a landmark whose observations contradict
  /// each other beyond the gate is left out. `scale`: factor on the noise.
  void setLandmarks(const WindowProblem& problem, const std::vector<WindowLandmark>& landmarks, bool gated,
                    double scale);
  /// Adds the white jerk between four knots, the first of which is below `end`.
  void addJerk(const WindowProblem& problem, int end);
  void addPrior(const WindowProblem& problem);

  /// Moves the landmarks given to setLandmarks() by what follows from a step of the other unknowns.
  void moveLandmarks(const Eigen::VectorXd& step, std::vector<WindowLandmark>& landmarks) const;
  WindowNoiseSums noiseSums() const { return sums_; }

  const Eigen::MatrixXd& information() const { return information_; }  ///< symmetric
  const Eigen::VectorXd& gradient() const { return gradient_; }

 private:
  /// Equations of the observations in a band of rows of a pair.
  struct Band {
    bool used = false;
    WindowBand middle;
    Eigen::Matrix<double, kObservationStates, kObservationStates> information;  ///< lower triangle
    Eigen::Matrix<double, kObservationStates, 1> gradient;
  };
  /// A landmark's elimination, for its own step.
  struct Eliminated {
    bool used = false;
    Eigen::Matrix3d root;  ///< lower triangular, of the information
  };

  Band& bandOf(const WindowProblem& problem, const WindowObservation& observation);
  Eliminated eliminate(const WindowProblem& problem, const WindowLandmark& landmark, bool gated, double scale,
                       Eigen::Index columns);
  void addBand(const Band& band);
  void subtractEliminated(Eigen::Index begin, Eigen::Index end, Eigen::Index from);

  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  WindowNoiseSums sums_;
  // Reused for their memory.
  std::vector<Band> bands_;
  std::vector<Eliminated> eliminated_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> cross_;  ///< information of a landmark with the unknowns
  Eigen::MatrixXd couplings_;  ///< three columns a landmark: root^-1 times its cross information, transposed
  Eigen::VectorXd gradients_;  ///< Eliminated::gradient of all
};

}  // namespace cartvo::vo
