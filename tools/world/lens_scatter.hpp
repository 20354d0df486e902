#pragma once

#include <opencv2/core/mat.hpp>

namespace cartvo::world {

/// What the lens scatters over the picture from what is far brighter than anything lit: the sun's disc where
/// it is seen. Adds it to `radiance` (CV_32FC1, unit: see Lighting); `focal_length` in px.
void scatterInLens(cv::Mat& radiance, double focal_length);

}  // namespace cartvo::world
