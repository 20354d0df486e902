#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace cartvo::doctor {

/// A picture of each camera, as decoded (neither undistorted nor rectified), exposed close to each other.
struct PicturePair {
  cv::Mat left, right;                ///< CV_8UC1; of the rig's size unless a finding of the stream says not
  std::int64_t left_exposure_ns = 0;  ///< since the Unix epoch, see capture::Frame
  std::int64_t right_exposure_ns = 0;
};

}  // namespace cartvo::doctor
