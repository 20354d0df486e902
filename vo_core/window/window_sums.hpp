#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "vo_core/simd/double_lanes.hpp"
#include "vo_core/window/observation_equations.hpp"
#include "vo_core/window/window_problem.hpp"

// Sums of a window's normal equations, the inner loops of WindowEquations.

namespace cartvo::vo {

constexpr int kStateGroups = kObservationStates / kDoubleLanes;
constexpr int kKnotGroups = 6 * Trajectory::kSupport / kDoubleLanes;

/// Derivatives of a camera's pose by the unknowns of its knots.
struct KnotMap {
  int first = 0;                      ///< of the knots
  DoubleLanes position[kKnotGroups];  ///< zero for turns of knots
  DoubleLanes turn[3][kKnotGroups];   ///< by the axes of the camera's turn

  void set(const Trajectory::Instant& instant);
};

/// Normal equations of the observations in a band of rows of a pair, by ObservationState. Elements left of
/// the diagonal's group are not set.
struct BandSums {
  KnotMap left, right;
  DoubleLanes products[kObservationStates][kStateGroups];

  void reset(const WindowBand& band);
  double operator()(int row, int column) const {
    return row / kDoubleLanes <= column / kDoubleLanes
               ? products[row][column / kDoubleLanes][column % kDoubleLanes]
               : products[column][row / kDoubleLanes][row % kDoubleLanes];
  }
};

/// Sums over bands and landmarks. Columns: six a knot, the shared states, the gradient.
class WindowSums {
 public:
  /// Sets all to zero.
  void reset(int knots, std::size_t landmarks);
  /// Adds an observation, its rows weighted, to the equations of its band and to the next landmark's.
  void add(const ObservationEquations& equations, const Eigen::Vector4d& weight, BandSums& band);
  void add(const BandSums& band);
  /// Eliminates the next landmark and returns its index. `root`: inverse of that of its information, lower
  /// triangular.
  std::size_t eliminate(const Eigen::Matrix3d& root);
  /// Subtracts the Schur complement of all landmarks.
  void subtractEliminated();

  /// Sets the equations in the order of WindowPrior. `information`: symmetric.
  void copyTo(Eigen::MatrixXd& information, Eigen::VectorXd& gradient) const;
  /// A step in the order of WindowPrior, for stepOf().
  void setStep(const Eigen::VectorXd& step);
  /// The gradient of an eliminated landmark after the step, times the inverse root.
  Eigen::Vector3d stepOf(std::size_t landmark) const;

  /// Inverse of a matrix of all unknowns by its root, lower triangular. Ends the use of the sums.
  Eigen::MatrixXd inverseBy(const Eigen::MatrixXd& root);

 private:
  struct alignas(64) Block {
    double value[8];
  };
  using Blocks = std::vector<Block>;

  int shared() const { return 6 * knots_; }  ///< first column of the shared states
  double* rowOf(std::size_t row) { return rows_[row * blocks_].value; }

  int knots_ = 0;
  std::size_t blocks_ = 0;  ///< of a row
  Blocks sums_;             ///< right of the diagonal, and more
  Blocks rows_;             ///< three of each landmark: inverse root times cross information
  Blocks row_;              ///< of unknowns
  std::vector<int> first_;  ///< knot of each landmark
  std::size_t count_ = 0;   ///< of landmarks
};

}  // namespace cartvo::vo
