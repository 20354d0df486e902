#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/simd/counting_sort.hpp"

namespace cartvo::vo {

/// Mean overlap of the patches of an adjusted bundle's landmarks: inflates the covariance for pixel noise
/// that landmarks share. Overlapping patches have correlated errors, but the least squares treat them as
/// independent, so the variance is too small by this factor (the mean of N errors with correlations r_ij has
/// the variance sum r_ij / N^2).
class PatchOverlap {
 public:
  /// Computes the mean number of patches of the same level that contain a pixel of a landmark's patch, its
  /// own included; >= 1. Averages over the landmarks in the newest pair, weighted by information; samples
  /// them if there are more than 250 in a level.
  double compute(const BundleProblem& problem);

 private:
  struct Patch {
    Eigen::Vector2d centre;  ///< in units of the patch side
    double information = 0.0;
  };

  /// Sums over the patches of one level.
  struct Sums {
    double information = 0.0, overlap = 0.0;  ///< `overlap` is weighted by information
  };

  Sums sumsOf(const BundleProblem& problem, int level);
  std::size_t cellOf(const Patch& patch) const;
  double overlapOf(const Patch& patch) const;

  // Reused for their memory.
  std::vector<Patch> patches_;  ///< of one level
  CountingSort by_cell_;        ///< patches_ by grid cell; cells are as wide as a patch
  int columns_ = 0, rows_ = 0;
};

}  // namespace cartvo::vo
