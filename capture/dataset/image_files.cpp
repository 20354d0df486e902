// Formats, lists, names and reading of image files.
#include "capture/dataset/image_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <stdexcept>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture/codec/image_completeness.hpp"
#include "common/ascii_text.hpp"
#include "common/files/foreign_format.hpp"
#include "common/input_file.hpp"
#include "common/natural_order.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 10> kExtensions{".png", ".jpg", ".jpeg", ".pgm",  ".ppm",
                                                  ".pnm", ".bmp", ".tif",  ".tiff", ".webp"};
constexpr std::uintmax_t kMaxFileBytes = 1U << 30U;

bool isDigit(char character) {
  return std::isdigit(static_cast<unsigned char>(character)) != 0;
}

[[noreturn]] void failToDecode(const fs::path& file, const std::string& problem) {
  if (const std::string format = foreignFormat(file); !format.empty())
    throw std::runtime_error(file.string() + " " + format);
  throw std::runtime_error(file.string() + ": " + problem + "; expected a complete file in " +
                           "one of the formats " + kImageFormats + "; copy it again");
}

/// Contents of a folder without images, for an error message.
std::string otherContents(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.')) return "; it contains '" + name + "'";
  }
  return "; it is empty";
}

/// The names without extension and without leading zeros.
std::vector<std::string> canonicalNames(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files)
    names.push_back(withoutLeadingZeros(file.stem().string()));
  return names;
}

/// Length of the longest text that all names begin with (`from_end` false) or end with, without the part of a
/// number that it may end in.
std::size_t commonLength(const std::vector<std::string>& names, bool from_end) {
  const auto at = [from_end](const std::string& name, std::size_t index) {
    return from_end ? name[name.size() - 1 - index] : name[index];
  };
  std::size_t length = names.front().size();
  for (const std::string& name : names) {
    length = std::min(length, name.size());
    std::size_t same = 0;
    while (same < length && at(name, same) == at(names.front(), same))
      ++same;
    length = same;
  }
  while (length > 0 && isDigit(at(names.front(), length - 1)))
    --length;
  return length;
}

/// Removes what all names of one camera begin with and end with.
std::vector<std::string> distinguishingParts(std::vector<std::string> names) {
  for (const bool from_end : {false, true}) {
    const std::size_t length = commonLength(names, from_end);
    for (std::string& name : names)
      name = from_end ? name.substr(0, name.size() - length) : name.substr(length);
  }
  return names;
}

NamedPairs pairKeys(const std::vector<fs::path>& left, const std::vector<std::string>& left_keys,
                    const std::vector<fs::path>& right, const std::vector<std::string>& right_keys) {
  std::map<std::string, std::size_t> partners;
  for (std::size_t i = 0; i < right.size(); ++i)
    partners.emplace(right_keys[i], i);
  NamedPairs result;
  std::vector<bool> has_partner(right.size(), false);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const auto partner = partners.find(left_keys[i]);
    if (partner == partners.end() || has_partner[partner->second]) {
      result.left_only.push_back(left[i]);
    } else {
      result.pairs.push_back({left[i].stem().string(), left[i], right[partner->second]});
      has_partner[partner->second] = true;
    }
  }
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (!has_partner[i]) result.right_only.push_back(right[i]);
  }
  return result;
}

}  // namespace

bool isImageFile(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  return !file.filename().string().starts_with('.') &&
         std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<fs::path> listImages(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && isImageFile(entry.path())) images.push_back(entry.path());
  }
  if (images.empty()) {
    throw std::runtime_error(folder.string() + " contains no image (" + kImageFormats + ")" +
                             otherContents(folder));
  }
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return NaturalOrder()(a.stem().string(), b.stem().string());
  });
  std::map<std::string, const fs::path*> by_name;
  for (const fs::path& image : images) {
    const auto [first, is_new] = by_name.emplace(withoutLeadingZeros(image.stem().string()), &image);
    if (is_new) continue;
    throw std::runtime_error(folder.string() +
                             " contains two images of one name: " + first->second->filename().string() +
                             " and " + image.filename().string() + "; remove one of them");
  }
  return images;
}

NamedPairs pairByName(const std::vector<fs::path>& left, const std::vector<fs::path>& right) {
  const std::vector<std::string> left_names = canonicalNames(left), right_names = canonicalNames(right);
  NamedPairs result = pairKeys(left, left_names, right, right_names);
  if (!result.pairs.empty() || left.empty() || right.empty()) return result;
  return pairKeys(left, distinguishingParts(left_names), right, distinguishingParts(right_names));
}

ImageSubfolders findImageSubfolders(const fs::path& folder) {
  static constexpr std::array<std::pair<const char*, const char*>, 4> kNames{
      {{"image_0", "image_1"}, {"image_2", "image_3"}, {"image_left", "image_right"}, {"left", "right"}}};
  for (const auto& [left, right] : kNames) {
    if (fs::is_directory(folder / left) && fs::is_directory(folder / right))
      return {folder / left, folder / right, left == std::string("image_2")};
  }
  return {};
}

cv::Mat decodeGreyImage(const fs::path& file) {
  const std::string bytes = readInputFile(file, kMaxFileBytes);
  if (bytes.empty()) failToDecode(file, "is empty");
  if (isCutOffImage(bytes)) failToDecode(file, "is cut off: its end is missing");
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  cv::Mat image;
  try {
    // The rig is that of the pixels as they are stored, as for videos and cameras.
    image = cv::imdecode(buffer, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) failToDecode(file, "cannot be decoded as an image");
  return image;
}

cv::Mat readGreyImage(const fs::path& file, const GreyRange& range) {
  cv::Mat image = decodeGreyImage(file);
  if (image.depth() == CV_8U) return image;
  if (image.depth() == CV_16U) return toEightBits(image, range);
  throw std::runtime_error(file.string() +
                           ": has values other than integers of 8 or 16 bits; convert it to 8 bits");
}

}  // namespace cartvo::capture
