#pragma once

#include <Eigen/Core>
#include <memory>

#include "vo_core/estimation/bundle_adjustment.hpp"

// Measurement of the right camera's calibration error from the vertical disparities of one pair.

namespace cartvo::vo {

/// Errors of the right camera that shift the rows of stereo matches: pitch, roll, delay and the cross term
/// (yaw + 2 p2), which shifts rows in proportion to x * y. The cross term is estimated to keep it out of the
/// other errors. It is not corrected, because the lenses of a good calibration leave a larger one than a
/// yaw that matters.
struct RowErrors {
  static constexpr int kSize = 4;
  enum Index { kPitch, kRoll, kCrossTerm, kDelay };  ///< rad, rad, rad, s; signs as RigCorrection's
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
};

/// All that shifts the rows of stereo matches: RowErrors, and what a calibration leaves of the right camera's
/// lens and of the baseline's direction. A delay of a camera that drives forward resembles these.
struct RowPatterns {
  static constexpr int kSize = RowErrors::kSize + 5;
  enum Index {
    kPitch = RowErrors::kPitch,
    kRoll = RowErrors::kRoll,
    kCrossTerm = RowErrors::kCrossTerm,
    kDelay = RowErrors::kDelay,
    kRowScale,    ///< relative error of the focal length for rows
    kRadial,      ///< Brown's k1
    kDecentring,  ///< Brown's p1
    kHeight,      ///< the right camera's centre below its place by the rig file, divided by the baseline
    kDepth        ///< the same, ahead of its place
  };
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
};

/// Normal equations of one pair for RowPatterns, about the applied correction.
struct RowEquations {
  RowPatterns::Matrix information = RowPatterns::Matrix::Zero();
  RowPatterns::Vector gradient = RowPatterns::Vector::Zero();       ///< information times patterns
  RowPatterns::Matrix mean_products = RowPatterns::Matrix::Zero();  ///< as RowMeasurement's
};

/// Row errors of one pair.
struct RowMeasurement {
  RowErrors::Vector errors = RowErrors::Vector::Zero();       ///< remaining after the applied correction
  RowErrors::Matrix information = RowErrors::Matrix::Zero();  ///< zero if there are too few matches
  /// Mean product of the rows' derivatives by the errors (px^2 per unit): sensitivity to row patterns that
  /// are not modelled.
  RowErrors::Matrix mean_products = RowErrors::Matrix::Zero();
  RowEquations equations;
};

/// Robust regression of the newest pair's vertical disparities on RowErrors, after subtraction of the motion
/// between the two exposures of an unsynchronised pair.
class RowRegression {
 public:
  RowRegression();
  RowRegression(RowRegression&&) noexcept;
  RowRegression& operator=(RowRegression&&) noexcept;
  ~RowRegression();

  RowMeasurement measure(const BundleProblem& adjusted);

 private:
  struct Work;
  std::unique_ptr<Work> work_;  // keeps its memory from problem to problem
};

/// Measures the row errors of a single problem. For many problems RowRegression reuses its memory.
RowMeasurement measureRows(const BundleProblem& adjusted);

}  // namespace cartvo::vo
