#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/solver/stereo_calibration.hpp"
#include "capture/dataset/grey_levels.hpp"

namespace cartvo {

/// The image files of one view.
struct ImagePair {
  std::string name;  ///< common to both files
  std::filesystem::path left, right;
};

/// Paired image files.
struct ImagePairs {
  std::vector<ImagePair> pairs;               ///< in NaturalOrder of their names
  std::vector<calib::RejectedView> unpaired;  ///< images without a partner
  capture::GreyLevels grey_levels;
};

/// Pairs the images of a folder by name, see capture::findImageSubfolders and capture::pairByName. Throws
/// std::runtime_error if it has no subfolders of left and right images, or there is no pair.
ImagePairs pairsInFolder(const std::filesystem::path& folder);

/// Pairs the files that match two patterns such as "L*.jpg" and "R*.jpg", each with one '*' in the file's
/// name, by the text that the '*' matches. Hidden files are left out. Throws std::invalid_argument for other
/// patterns, std::runtime_error if there is no pair.
ImagePairs pairsByPattern(const std::filesystem::path& left, const std::filesystem::path& right);

}  // namespace cartvo
