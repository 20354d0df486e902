#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/grouped_order.hpp"

namespace cartvo {

/// How much the patches of an adjusted bundle's landmarks overlap. Landmarks whose patches share pixels share
/// what noise does to them there; the least squares take them for independent and believe the result more
/// than they should: by this factor, in variance (of N errors whose correlations are r_ij, the mean has the
/// variance sum r_ij / N^2).
class PatchOverlap {
 public:
  /// The mean over the landmarks that the newest pair saw, each by its information: of how many patches of
  /// its own level, itself one of them, a pixel of its patch is part. 1 and more. Of very many
  /// landmarks only some are asked.
  double of(const BundleProblem& problem);

 private:
  struct Patch {
    Eigen::Vector2d centre;  ///< in patches' sides
    double information = 0.0;
  };

  /// Sums over one level's patches.
  struct Sums {
    double information = 0.0, overlap = 0.0;  ///< the latter weighted by the former
  };

  Sums sumsOf(const BundleProblem& problem, int level);
  std::size_t cellOf(const Patch& patch) const;
  double overlapOf(const Patch& patch) const;

  // Kept for their memory.
  std::vector<Patch> patches_;  ///< of one level
  GroupedOrder by_cell_;        ///< of these; cells are a patch's side wide
  int columns_ = 0, rows_ = 0;
};

}  // namespace cartvo
