#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "pipeline/pair_view.hpp"

// Data that the page receives for one instant: numbers, landmarks and both pictures, which belong together.

namespace cartvo::daemon {

/// Both pictures as one JPEG, the left above the right, each of `width` times `height` px: half the size (or
/// a quarter) of the left one if this is wider than 960 px. A picture that is missing is black.
struct EncodedPictures {
  std::string jpeg;  ///< empty: no pictures
  int width = 0, height = 0;
  int scale = 1;  ///< px of the picture for each px
};

/// Uses no threads of OpenCV, which are the odometry's.
EncodedPictures encodePictures(const cv::Mat& left, const cv::Mat& right);

/// The JSON of pictures that are no pair: {"width": .., "height": .., "scale": .., "sequence": null}.
std::string unpairedJson(const EncodedPictures& pictures);

/// {"width": .., "height": .., "scale": .., "sequence": .., "stages_ms": {NAME: .., ..., "all": ..}, "still":
/// [[x, y, width, height], ...], "landmarks": [[left x, left y, right x, right y, weight, age, inverse
/// depth],
/// ...]}, px of the rectified pictures. `sequence`: of the pair's message.
std::string picturesJson(const EncodedPictures& pictures, const pipeline::PairView& view,
                         std::int64_t sequence);

/// Length of `json` in bytes (32 bits, little-endian), `json`, `jpeg`.
std::string frameBytes(const std::string& json, const std::string& jpeg);

}  // namespace cartvo::daemon
