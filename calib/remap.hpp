#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/rectification_tables.hpp"

namespace cartvo {

/// Fills `target` (CV_8UC1) with `source`'s grey values at the table's places, bilinearly interpolated with
/// weights of 1/256 and rounded once, to the nearest. `sources` must hold a place for each pixel of `target`,
/// all within `source` (see PixelSources); that is not checked here.
void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target);

}  // namespace cartvo
