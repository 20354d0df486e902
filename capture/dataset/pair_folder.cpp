// The images of both cameras in one folder: told apart by their names, or side by side in each image.
#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "capture/dataset/image_files.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "capture/dataset/image_instants.hpp"
#include "common/ascii_text.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

/// Words in the names of the left and of the right images, in lower case. The first pair that both sides have
/// counts.
constexpr std::array<std::pair<const char*, const char*>, 4> kSides{
    {{"left", "right"}, {"l", "r"}, {"i1", "i2"}, {"cam0", "cam1"}}};

/// Adds the longest parts of the text whose characters all pass.
void addWords(const std::string& text, const std::function<bool(unsigned char)>& passes,
              std::set<std::string>& words) {
  std::string word;
  for (const char character : text + '\0') {
    if (passes(static_cast<unsigned char>(character))) {
      word += character;
    } else if (!word.empty()) {
      words.insert(std::exchange(word, {}));
    }
  }
}

/// The words of a name: of letters, and of letters and digits.
std::set<std::string> wordsOf(const fs::path& image) {
  const std::string name = lowerCase(image.stem().string());
  std::set<std::string> words;
  addWords(
      name, [](unsigned char c) { return std::isalpha(c) != 0; }, words);
  addWords(
      name, [](unsigned char c) { return std::isalnum(c) != 0; }, words);
  return words;
}

struct Sides {
  std::vector<fs::path> left, right;
  std::size_t others = 0;  ///< images of neither side
};

/// Tells the images of both cameras apart. Both lists are empty if the names do not name both sides.
Sides splitSides(const std::vector<fs::path>& images) {
  std::vector<std::set<std::string>> words;
  std::transform(images.begin(), images.end(), std::back_inserter(words), wordsOf);
  for (const auto& [left, right] : kSides) {
    Sides sides;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const bool is_left = words[i].contains(left), is_right = words[i].contains(right);
      if (is_left == is_right) {
        ++sides.others;
      } else {
        (is_left ? sides.left : sides.right).push_back(images[i]);
      }
    }
    if (!sides.left.empty() && !sides.right.empty()) return sides;
  }
  return {};
}

bool hasImages(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.is_regular_file() && isImageFile(entry.path())) return true;
  return false;
}

/// `folder` and the subfolders whose name passes, if they contain images.
std::vector<fs::path> foldersWithImages(const fs::path& folder,
                                        const std::function<bool(const std::string& name)>& passes) {
  std::vector<fs::path> found;
  if (hasImages(folder)) found.push_back(folder);
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const bool is_candidate = entry.is_directory() && passes(lowerCase(entry.path().filename().string()));
    if (is_candidate && hasImages(entry.path())) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Completes a folder whose images are listed: instants, and the files with the rig, which lie beside the
/// images or in the folder above that was given.
void complete(ImageFolder& result, const fs::path& images, const fs::path& folder, double frame_rate) {
  std::vector<fs::path> places{images};
  if (folder != images) places.push_back(folder);
  result.folder = folder;
  readInstants(result, places, frame_rate);
  for (const fs::path& place : places) {
    if (result.rig_file.empty()) result.rig_file = pathIfExists(place / "rig.yaml");
    if (result.calib_file.empty()) result.calib_file = pathIfExists(place / "calib.txt");
  }
}

}  // namespace

std::optional<fs::path> findPairFolder(const fs::path& folder) {
  const auto candidates =
      foldersWithImages(folder, [](const std::string& name) { return name.ends_with("images"); });
  for (const fs::path& candidate : candidates)
    if (!splitSides(listImages(candidate)).left.empty()) return candidate;
  return std::nullopt;
}

ImageFolder readPairFolder(const fs::path& folder, const ImageFolderSettings& settings) {
  const fs::path images = *findPairFolder(folder);
  Sides sides = splitSides(listImages(images));
  ImageFolder result;
  result.layout = FolderLayout::one_folder;
  result.left.images = std::move(sides.left);
  result.right.images = std::move(sides.right);
  if (sides.others > 0) {
    result.warnings.push_back(images.string() + ": " + std::to_string(sides.others) +
                              " images whose names name neither the left nor the right camera are left out");
  }
  complete(result, images, folder, settings.frame_rate);
  return result;
}

ImageFolder readSideBySideFolder(const fs::path& folder, const ImageFolderSettings& settings) {
  const auto candidates = foldersWithImages(
      folder, [](const std::string& name) { return name == "images" || name == "image" || name == "data"; });
  if (candidates.empty()) {
    throw std::runtime_error(
        folder.string() + " contains no image (" + kImageFormats +
        "), nor do its subfolders images, image and data; --side-by-side expects images "
        "with the left camera's picture in the left half and the right camera's beside it");
  }
  ImageFolder result;
  result.layout = FolderLayout::one_folder;
  result.left.images = result.right.images = listImages(candidates.front());
  result.left.part = PicturePart::left_half;
  result.right.part = PicturePart::right_half;
  complete(result, candidates.front(), folder, settings.frame_rate);
  return result;
}

}  // namespace cartvo::capture
