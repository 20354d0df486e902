#pragma once

#include <opencv2/core/mat.hpp>

#include "capture/codec/ffmpeg.hpp"

namespace cartvo::capture {

/// The frame's luma plane as a grey image, CV_8UC1: a view of the frame's memory if it has 8 bits, else a
/// copy reduced to 8 bits. Empty if the format has no luma plane in main memory. Full-range and limited-range
/// luma are not converted.
cv::Mat lumaPlane(const AVFrame& frame);

/// As lumaPlane; the luma of other formats, such as RGB or interleaved YUYV, is computed. Empty if the format
/// is not in main memory or FFmpeg cannot convert it.
cv::Mat greyPicture(const AVFrame& frame);

}  // namespace cartvo::capture
