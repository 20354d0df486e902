#pragma once

#include <Eigen/Core>
#include <array>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/geometry/image_cells.hpp"
#include "vo_core/geometry/residual_variance.hpp"

namespace cartvo::vo {

/// Variance of the residuals in each cell of the image, by which landmarks are weighted: leaves that sway or
/// cover each other have larger residuals than a road of the same contrast, for as long as they are seen.
class CellNoise {
 public:
  /// `correlated_pairs`: memory in pairs, see SelfCalibrationSettings. `outlier_stddevs`: largest normalised
  /// residual that counts; larger ones are the landmark's own.
  CellNoise(double correlated_pairs, double outlier_stddevs);

  /// Factor on the weight of a landmark that was last seen at `pixel`: inverse of the cell's variance over
  /// the harmonic mean of all landmarks, so that the factors of the last adjusted pair have the mean 1 and
  /// the information of all landmarks is that of BundleNoises. 1 before the first update.
  double weightAt(const StereoCamera& camera, const Eigen::Vector2d& pixel) const;

  /// Adds the residuals of an adjusted window's newest pair.
  void update(const BundleProblem& adjusted);

 private:
  double pairs_;
  double largest_square_;
  std::array<ResidualVariance, kCells> residuals_;
  std::array<double, kCells> weights_;
};

}  // namespace cartvo::vo
