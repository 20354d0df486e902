#pragma once

#include <opencv2/core/mat.hpp>

namespace cartvo::world {

/// Adds veiling glare to `radiance` (CV_32FC1, unit: see Lighting): light that the lens scatters over the
/// image from a visible sun. `focal_length` in px.
void addVeilingGlare(cv::Mat& radiance, double focal_length);

}  // namespace cartvo::world
