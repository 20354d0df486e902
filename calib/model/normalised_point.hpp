#pragma once

namespace cartvo::calib {

/// Normalised image coordinates: (x/z, y/z), a point on the image plane at distance 1 from the camera.
struct NormalisedPoint {
  double x = 0.0, y = 0.0;
};

}  // namespace cartvo::calib
