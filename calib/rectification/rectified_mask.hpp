#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/model/static_mask.hpp"
#include "calib/rectification/rectification_tables.hpp"

namespace cartvo::calib {

/// The mask as it lies in the rectified image: 0 where one of the four raw pixels that the rectified one is
/// interpolated from must not be used, 255 elsewhere; empty for an empty mask. `sources`: of images of the
/// mask's size; empty if the images are already rectified.
cv::Mat rectifiedMask(const StaticMask& mask, const PixelSources& sources);

}  // namespace cartvo::calib
