#pragma once

#include <array>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/lane_order.hpp"
#include "vo_core/reprojection_lanes.hpp"

// A bundle's landmarks, four at a time. Not for use outside the bundle adjustment.

namespace cartvo {

/// Up to four landmarks of one host, a lane each. Lanes beyond `count` see nothing and weigh nothing.
struct LandmarkBlock {
  int host = 0;
  int count = 0;
  std::array<int, kDoubleLanes> landmark{};           ///< index into the problem's
  std::array<int, kDoubleLanes> level{};              ///< BundleLandmark's
  std::size_t first_sighting = 0, last_sighting = 0;  ///< [first, last) of the sightings
  PlaceLanes place{};
  DoubleLanes weight{};
  DoubleLanes prior_inverse_depth{}, prior_information{}, prior_by_late_right{};
};

/// What one pair saw of a block's landmarks; px.
struct SightingBlock {
  int pose = 0;
  DoubleLanes seen{}, stereo{};  ///< 1 where they are, else 0
  DoubleLanes left[2]{}, right[2]{};
  DoubleLanes position_precision[2]{}, disparity_precision{};  ///< 1/px
};

class BundleBlocks {
 public:
  void take(const BundleProblem& problem);

  std::vector<LandmarkBlock> landmarks;
  std::vector<SightingBlock> sightings;  ///< of each block its pairs, oldest first

 private:
  void add(const BundleProblem& problem, int host, const int* first, int count);

  LaneOrder order_;
};

}  // namespace cartvo
