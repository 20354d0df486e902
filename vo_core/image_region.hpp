#pragma once

#include "vo_core/geometry/fixed_vector.hpp"

namespace cartvo::vo {

/// Rectangle of the rectified left image, px.
struct ImageRegion {
  int x = 0, y = 0;  ///< of the upper left corner
  int width = 0, height = 0;
};

constexpr std::size_t kMaximumImageRegions = 8;
using ImageRegions = FixedVector<ImageRegion, kMaximumImageRegions>;

}  // namespace cartvo::vo
