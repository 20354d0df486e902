#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/rectification/rectification_tables.hpp"

namespace cartvo::calib {

/// Fills `target` (CV_8UC1) with the grey values of `source` at the positions of the table, by bilinear
/// interpolation with weights of 1/256, rounded once to the nearest integer. `sources` must contain one
/// position within `source` for each pixel of `target` (see PixelSources); this is not checked.
void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target);

}  // namespace cartvo::calib
