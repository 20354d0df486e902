#pragma once

// Readers of the layouts that readImageFolder supports; internal to capture.

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/dataset/image_folder.hpp"

namespace cartvo::capture {

/// KITTI's odometry layout, and folders of numbered images of other names, see findImageSubfolders.
bool isKittiFolder(const std::filesystem::path& folder);
ImageFolder readKittiFolder(const std::filesystem::path& folder, const ImageFolderSettings& settings);

/// KITTI's raw recordings: image_00/data and image_01/data, or image_02 and image_03, each with
/// timestamps.txt.
bool isKittiRawFolder(const std::filesystem::path& folder);
ImageFolder readKittiRawFolder(const std::filesystem::path& folder);

/// The folder that contains cam0 and cam1: `folder` itself or its subfolder mav0; nothing if neither does.
std::optional<std::filesystem::path> findEurocFolder(const std::filesystem::path& folder);
ImageFolder readEurocFolder(const std::filesystem::path& folder);

/// The folder with the images of both cameras, told apart by their names (left and right, L and R, I1 and I2,
/// cam0 and cam1): `folder` itself, or its subfolder StereoImages (New College), Images or NAME_Images
/// (Malaga); nothing if none of them has such images.
std::optional<std::filesystem::path> findPairFolder(const std::filesystem::path& folder);
ImageFolder readPairFolder(const std::filesystem::path& folder, const ImageFolderSettings& settings);

/// Lists of images with their instants: left.txt and right.txt, or cam0.txt and cam1.txt.
bool isListFolder(const std::filesystem::path& folder);
ImageFolder readListFolder(const std::filesystem::path& folder);

/// Images that each contain the left camera's picture in their left half and the right one's in the other:
/// in `folder` itself or in its subfolder images, image or data.
ImageFolder readSideBySideFolder(const std::filesystem::path& folder, const ImageFolderSettings& settings);

/// `file` if it exists, else the empty path.
std::filesystem::path pathIfExists(const std::filesystem::path& file);

/// Largest magnitude of an instant, ns: differences of two instants do not overflow.
inline constexpr std::int64_t kMaxTimestampNs = 4'000'000'000'000'000'000;

/// One line of a text file with its number, for error messages.
struct TextLine {
  int number = 0;
  std::string text;  ///< without surrounding white space; not empty
};

/// The lines of a file except empty ones and comments (#). Throws std::runtime_error if the file cannot be
/// read.
std::vector<TextLine> readLines(const std::filesystem::path& file);

/// "FILE, line N: " for error messages.
std::string fileAndLine(const std::filesystem::path& file, const TextLine& line);

/// Parses the whole of `text` as a number, with or without a sign; nothing if it is not one.
template <typename Number>
std::optional<Number> parseNumber(std::string_view text) {
  Number value{};
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Throws std::runtime_error naming file and line unless the instant is later than the last of `previous`.
void requireIncreasing(const std::vector<std::int64_t>& previous, std::int64_t instant_ns,
                       const std::filesystem::path& file, const TextLine& line);

/// Throws std::runtime_error naming both unless there is an instant for each image.
void requireInstantForEachImage(const ImageSequence& sequence, const std::filesystem::path& folder,
                                const std::filesystem::path& times);

}  // namespace cartvo::capture
