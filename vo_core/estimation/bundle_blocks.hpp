#pragma once

#include <array>
#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/geometry/reprojection_lanes.hpp"
#include "vo_core/simd/simd_groups.hpp"

// Landmarks of a bundle problem in SIMD blocks of four. Internal to the bundle adjustment.

namespace cartvo::vo {

/// Up to four landmarks of one anchor, one in each lane. Lanes from `count` on have no observation and no
/// weight.
struct LandmarkBlock {
  int anchor = 0;
  int count = 0;
  std::array<int, kDoubleLanes> landmark{};                 ///< index into the problem's landmarks
  std::array<int, kDoubleLanes> level{};                    ///< pyramid level
  std::size_t first_observation = 0, last_observation = 0;  ///< range [first, last)
  PlaceLanes place{};
  DoubleLanes weight{};
  DoubleLanes prior_inverse_depth{}, prior_information{}, prior_dinverse_depth_doffset{};
};

/// Observations of a block's landmarks by one pair; px.
struct ObservationBlock {
  int pose = 0;
  DoubleLanes seen{}, stereo{};  ///< 1 if the landmark was observed (in both images), else 0
  DoubleLanes left[2]{}, right[2]{};
  DoubleLanes position_precision[2]{}, disparity_precision{};  ///< 1/px
};

/// All landmarks and observations of a problem, sorted by anchor.
class BundleBlocks {
 public:
  void reset(const BundleProblem& problem);

  std::vector<LandmarkBlock> landmarks;
  std::vector<ObservationBlock> observations;  ///< by block, then by pair, oldest first

 private:
  void add(const BundleProblem& problem, int anchor, const int* first, int count);

  SimdGroups order_;
};

}  // namespace cartvo::vo
