#pragma once

#include <vector>

namespace cartvo::vo {

/// Rectangle of the rectified left image, px.
struct ImageRegion {
  int x = 0, y = 0;  ///< of the upper left corner
  int width = 0, height = 0;
};

using ImageRegions = std::vector<ImageRegion>;

}  // namespace cartvo::vo
