// Pairing of left and right image files by name.
#include "tools/calibrate/views/image_pairs.hpp"

#include <map>
#include <stdexcept>
#include <utility>

#include "capture/dataset/image_files.hpp"
#include "common/natural_order.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

using NamedFiles = std::map<std::string, fs::path, NaturalOrder>;

NamedFiles matching(const fs::path& pattern) {
  const std::string name = pattern.filename().string();
  const std::size_t star = name.find('*');
  if (star == std::string::npos || name.find('*', star + 1) != std::string::npos ||
      pattern.parent_path().string().find('*') != std::string::npos) {
    throw std::invalid_argument("'" + pattern.string() +
                                "': expected a pattern with one '*' in the file's name");
  }
  const std::string before = name.substr(0, star), after = name.substr(star + 1);
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + ": is not a folder");
  NamedFiles files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (entry.is_regular_file() && !file.starts_with('.') && file.size() > before.size() + after.size() &&
        file.starts_with(before) && file.ends_with(after)) {
      files.emplace(file.substr(before.size(), file.size() - before.size() - after.size()), entry.path());
    }
  }
  if (files.empty()) throw std::runtime_error(pattern.string() + ": no file matches this pattern");
  return files;
}

ImagePairs paired(const NamedFiles& left, const NamedFiles& right) {
  ImagePairs result;
  for (const auto& [name, file] : left) {
    if (const auto partner = right.find(name); partner != right.end()) {
      result.pairs.push_back({name, file, partner->second});
    } else {
      result.unpaired.push_back({name, "there is no right image for " + file.string()});
    }
  }
  for (const auto& [name, file] : right) {
    if (!left.contains(name))
      result.unpaired.push_back({name, "there is no left image for " + file.string()});
  }
  return result;
}

/// Measures the values of both cameras.
ImagePairs withGreyLevels(ImagePairs pairs) {
  std::vector<fs::path> left, right;
  for (const ImagePair& pair : pairs.pairs) {
    left.push_back(pair.left);
    right.push_back(pair.right);
  }
  pairs.grey_levels = capture::measureGreyLevels(left, right);
  return pairs;
}

}  // namespace

ImagePairs pairsInFolder(const fs::path& folder) {
  if (!fs::exists(folder)) {
    throw std::runtime_error(
        folder.string() +
        ": does not exist, and so contains no subfolders image_0 (left) and image_1 (right); "
        "'cartvo calibrate' takes such a folder, a recording, 'live', or one of the commands "
        "board, check, convert, mount and plan");
  }
  const capture::ImageSubfolders images = capture::findImageSubfolders(folder);
  if (images.left.empty()) {
    throw std::runtime_error(folder.string() +
                             ": contains no subfolders image_0 (left) and image_1 (right); or give "
                             "--left-images and --right-images with patterns "
                             "such as 'L*.jpg' and 'R*.jpg'");
  }
  capture::NamedPairs named =
      capture::pairByName(capture::listImages(images.left), capture::listImages(images.right));
  if (named.pairs.empty()) {
    throw std::runtime_error(folder.string() + ": no image in " + images.left.filename().string() +
                             " has the same name as one in " + images.right.filename().string());
  }
  ImagePairs result;
  for (capture::NamedPairs::Pair& pair : named.pairs)
    result.pairs.push_back({std::move(pair.name), std::move(pair.left), std::move(pair.right)});
  for (const fs::path& file : named.left_only)
    result.unpaired.push_back({file.stem().string(), "there is no right image for " + file.string()});
  for (const fs::path& file : named.right_only)
    result.unpaired.push_back({file.stem().string(), "there is no left image for " + file.string()});
  return withGreyLevels(std::move(result));
}

ImagePairs pairsByPattern(const fs::path& left, const fs::path& right) {
  ImagePairs result = paired(matching(left), matching(right));
  if (result.pairs.empty()) {
    throw std::runtime_error("no two files form a pair: the text that '*' matches in " + left.string() +
                             " and in " + right.string() + " is never the same");
  }
  return withGreyLevels(std::move(result));
}

}  // namespace cartvo
