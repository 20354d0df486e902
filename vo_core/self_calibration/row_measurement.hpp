#pragma once

#include <Eigen/Core>
#include <memory>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/self_calibration_settings.hpp"

// Measurement of the right camera's calibration error from the vertical disparities of one pair.

namespace cartvo::vo {

/// All that shifts the rows of stereo matches: errors of the right camera, and what a calibration leaves of
/// its lens and of the baseline's direction. A delay of a camera that drives forward resembles these.
struct RowPatterns {
  enum Index {
    kPitch,       ///< rad, as RigCorrection's
    kRoll,        ///< rad, as RigCorrection's
    kCrossTerm,   ///< rad, in proportion to x y: yaw + 2 p2, and more of it that lenses leave
    kDelay,       ///< s
    kRowScale,    ///< relative error of the focal length for rows
    kRadial,      ///< Brown's k1
    kDecentring,  ///< Brown's p1
    kHeight,      ///< the right camera's centre below its place by the rig file, divided by the baseline
    kDepth,       ///< the same, ahead of its place
    kSize
  };
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
};

/// Normal equations of one pair for the patterns, about expected ones.
struct RowMeasurement {
  RowPatterns::Matrix information = RowPatterns::Matrix::Zero();
  RowPatterns::Vector gradient = RowPatterns::Vector::Zero();  ///< information times remaining patterns
  /// Mean product of the rows' derivatives by the patterns (px^2 per unit): sensitivity to patterns that are
  /// not modelled.
  RowPatterns::Matrix mean_products = RowPatterns::Matrix::Zero();
  double precision = 0.0;  ///< 1/px^2, sum of the rows' inverse variances; 0 if there are too few matches
};

/// Robust equations of the newest pair's vertical disparities, after subtraction of the motion between the
/// two exposures of an unsynchronised pair.
class RowRegression {
 public:
  explicit RowRegression(const SelfCalibrationSettings& settings);
  RowRegression(RowRegression&&) noexcept;
  RowRegression& operator=(RowRegression&&) noexcept;
  ~RowRegression();

  /// `expected`: patterns expected in the rows as they are. The more a row differs, the less its weight.
  RowMeasurement measure(const BundleProblem& adjusted, const RowPatterns::Vector& expected);

 private:
  struct Work;
  SelfCalibrationSettings settings_;
  std::unique_ptr<Work> work_;  // keeps its memory from problem to problem
};

}  // namespace cartvo::vo
