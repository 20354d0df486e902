#pragma once

#include <cstdint>
#include <vector>

// Landmarks of the newest pair as a display shows them.

namespace cartvo::vo {

/// A landmark where it was observed in the newest pair, px of the rectified images.
struct LandmarkView {
  float left_x = 0.0F, left_y = 0.0F;
  float right_x = 0.0F, right_y = 0.0F;        ///< NaN without a stereo match
  float previous_x = 0.0F, previous_y = 0.0F;  ///< in the left image tracked before; NaN: not observed there
  float weight = 0.0F;                         ///< in [0, 1], as part of the static world
  std::int32_t age = 0;                        ///< pairs with an observation
  float inverse_depth = 0.0F;                  ///< 1/m, from its anchor camera; NaN: not known
};

using LandmarkViews = std::vector<LandmarkView>;

}  // namespace cartvo::vo
