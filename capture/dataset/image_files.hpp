#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "capture/dataset/grey_levels.hpp"

// Image files: formats, lists, pairs by name, and reading as grey.

namespace cartvo::capture {

/// Names of the image formats, for messages.
inline constexpr const char* kImageFormats = "PNG, JPEG, PGM, PPM, BMP, TIFF, WebP";

/// Whether a file's name has the extension of one of kImageFormats and is not hidden. Hidden files, with a
/// dot in front, are other programs' notes, such as the "._NAME.png" of macOS.
bool isImageFile(const std::filesystem::path& file);

/// The image files of a folder, in NaturalOrder of their names. Throws std::runtime_error naming the folder
/// if it cannot be read, contains none, or contains two images of one name (also "7.png" and "007.png").
std::vector<std::filesystem::path> listImages(const std::filesystem::path& folder);

/// The images of two cameras that belong together by their names.
struct NamedPairs {
  struct Pair {
    std::string name;  ///< common to both
    std::filesystem::path left, right;
  };
  std::vector<Pair> pairs;                                   ///< in the order of the left images
  std::vector<std::filesystem::path> left_only, right_only;  ///< images without a partner
};

/// Pairs images by name. Names are equal if they differ only by leading zeros or the extension. If no name is
/// in both lists, the parts are compared that differ within a list: left_07.png belongs to right_07.png.
NamedPairs pairByName(const std::vector<std::filesystem::path>& left,
                      const std::vector<std::filesystem::path>& right);

/// The subfolders of a folder with the left and the right images: image_0 and image_1 (KITTI, grey), image_2
/// and image_3 (KITTI, colour), image_left and image_right, or left and right. The first pair that exists;
/// empty paths if none does.
struct ImageSubfolders {
  std::filesystem::path left, right;
  bool is_colour = false;  ///< KITTI's cameras 2 and 3
};
ImageSubfolders findImageSubfolders(const std::filesystem::path& folder);

/// Reads an image as grey with the bits that it has, as it is stored: an orientation in the file is ignored.
/// Throws std::runtime_error naming the file if it cannot be read, decoded, or is not complete.
cv::Mat decodeGreyImage(const std::filesystem::path& file);

/// Reads an image as grey, CV_8UC1, 16-bit values by their range. Throws as decodeGreyImage, and for images
/// of other than 8 or 16 bits.
cv::Mat readGreyImage(const std::filesystem::path& file, const GreyRange& range = {});

}  // namespace cartvo::capture
