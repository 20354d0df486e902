#pragma once

#include <Eigen/Core>
#include <vector>

#include "vo_core/simd/counting_sort.hpp"
#include "vo_core/window/observation_equations.hpp"
#include "vo_core/window/window_problem.hpp"
#include "vo_core/window/window_sums.hpp"

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

/// How a landmark fits the trajectory.
struct LandmarkFit {
  double square = 0.0;       ///< mean of its newest residuals over their scales, squared
  double right_row = 0.0;    ///< px, residual of its newest row in the right image, if it has one
  double information = 0.0;  ///< m^2, of its inverse depth given all poses; 0: it has been left out
};

/// Normal equations about the problem's values. Unknowns as WindowPrior's.
class WindowEquations {
 public:
  /// Equations of observations, with the landmarks eliminated (Schur complement of 3 x 3 blocks; B. Triggs et
  /// al., "Bundle adjustment - a modern synthesis", 2000). `gated`: a landmark whose observations contradict
  /// each other beyond the gate is left out. `scale`: factor on the noise. `noise`: null, or what the
  /// residuals are added to.
  void setLandmarks(const WindowProblem& problem, const std::vector<WindowLandmark>& landmarks, bool gated,
                    double scale, WindowNoiseSums* noise = nullptr);
  /// Adds the white jerk between four knots, the first of which is below `end`.
  void addJerk(const WindowProblem& problem, int end);
  void addPrior(const WindowProblem& problem);

  /// Takes off what the equations of setLandmarks() and addJerk() pretend to know of readouts and offset
  /// beside `prior`. The derivatives by these are those by time: errors of the twists, squared, appear as
  /// information (W. Fuller, "Measurement Error Models", 1987, section 1.1). As much is lost to a state of
  /// these equations' own; at rest that is all.
  void discountTimes(const WindowPrior& prior);

  /// How the landmark with this index fitted in setLandmarks().
  const LandmarkFit& fit(std::size_t landmark) const { return eliminated_[landmark].fit; }

  /// Moves the landmarks given to setLandmarks() by what follows from a step of the other unknowns.
  void moveLandmarks(const Eigen::VectorXd& step, std::vector<WindowLandmark>& landmarks);

  /// Covariance by the root of the information, lower triangular; the last call after setLandmarks().
  Eigen::MatrixXd covarianceBy(const Eigen::MatrixXd& root) { return sums_.inverseBy(root); }

  const Eigen::MatrixXd& information() const { return information_; }  ///< symmetric
  const Eigen::VectorXd& gradient() const { return gradient_; }

 private:
  /// A band of rows of a pair.
  struct Band {
    bool used = false;
    WindowBand middle;
    BandSums sums;
  };
  /// A landmark's elimination, for its own step.
  struct Eliminated {
    bool used = false;
    std::size_t index = 0;         ///< in sums_
    Eigen::Matrix3d root_inverse;  ///< lower triangular, of the information
    LandmarkFit fit;
  };

  Band& bandOf(const WindowProblem& problem, const WindowObservation& observation);
  Eliminated eliminate(const WindowProblem& problem, const WindowLandmark& landmark, bool gated, double scale,
                       WindowNoiseSums* noise);

  void addPretended(std::size_t band, const Matrix6d& covariance);

  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  /// 1/s^2, information of the readouts and the offset by errors.
  Eigen::Vector3d pretended_ = Eigen::Vector3d::Zero();
  // Reused for their memory.
  std::vector<Band> bands_;
  std::vector<Eliminated> eliminated_;
  CountingSort by_band_;  ///< landmarks, by the band of their first observation
  WindowSums sums_;
};

}  // namespace cartvo::vo
