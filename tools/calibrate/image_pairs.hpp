#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/stereo_calibration.hpp"

namespace cartvo {

/// The images of one view on disk.
struct ImagePair {
  std::string name;  ///< what both files have in common
  std::filesystem::path left, right;
};

struct ImagePairs {
  std::vector<ImagePair> pairs;        ///< in the order of their names, numbers by value
  std::vector<RejectedView> unpaired;  ///< images whose partner is missing
};

/// The images of equal name in `folder`/image_0 and `folder`/image_1. Throws std::runtime_error if a folder
/// is missing or nothing pairs.
ImagePairs pairsInFolder(const std::filesystem::path& folder);

/// The files that fit two patterns such as "L*.jpg" and "R*.jpg", each with one '*' in the file's name,
/// paired by what the '*' stands for. Throws std::invalid_argument for other patterns, std::runtime_error if
/// nothing fits.
ImagePairs pairsByPattern(const std::filesystem::path& left, const std::filesystem::path& right);

/// A grey image (CV_8UC1). Throws std::runtime_error naming the file if it is no image.
cv::Mat readGrey(const std::filesystem::path& file);

}  // namespace cartvo
