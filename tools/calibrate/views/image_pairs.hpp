#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/solver/stereo_calibration.hpp"

namespace cartvo {

/// The image files of one view.
struct ImagePair {
  std::string name;  ///< common to both files
  std::filesystem::path left, right;
};

/// Paired image files.
struct ImagePairs {
  std::vector<ImagePair> pairs;               ///< sorted by name, with numbers compared by value
  std::vector<calib::RejectedView> unpaired;  ///< images without a partner
};

/// Pairs the images of equal name in `folder`/image_0 and `folder`/image_1. Throws std::runtime_error if a
/// folder is missing or there is no pair.
ImagePairs pairsInFolder(const std::filesystem::path& folder);

/// Pairs the files that match two patterns such as "L*.jpg" and "R*.jpg", each with one '*' in the file's
/// name, by the text that the '*' matches. Throws std::invalid_argument for other patterns,
/// std::runtime_error if there is no pair.
ImagePairs pairsByPattern(const std::filesystem::path& left, const std::filesystem::path& right);

/// Reads an image as grey (CV_8UC1). Throws std::runtime_error naming the file if it is not an image.
cv::Mat readGrey(const std::filesystem::path& file);

}  // namespace cartvo
