#pragma once

#include <opencv2/core/mat.hpp>

#include "capture/ffmpeg.hpp"

namespace cartvo {

/// The frame's luma as a grey image (CV_8UC1): in the frame's own memory where it is 8 bits deep, else copied
/// and reduced to that. Empty if the format has no luma plane in main memory. Full-range and limited-range
/// luma are both taken as they are.
cv::Mat lumaPlane(const AVFrame& frame);

}  // namespace cartvo
