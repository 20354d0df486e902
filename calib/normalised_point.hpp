#pragma once

namespace cartvo {

/// A point of the image plane at distance 1 from the camera: (x/z, y/z).
struct NormalisedPoint {
  double x = 0.0, y = 0.0;
};

}  // namespace cartvo
