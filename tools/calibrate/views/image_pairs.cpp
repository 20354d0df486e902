// Pairing of left and right image files by name.
#include "tools/calibrate/views/image_pairs.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

namespace cartvo {
namespace {

namespace fs = std::filesystem;

/// Orders names with numbers by value: "view2" before "view10".
struct NumbersByValue {
  bool operator()(const std::string& a, const std::string& b) const {
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    std::size_t i = 0, k = 0;
    while (i < a.size() && k < b.size()) {
      if (!is_digit(a[i]) || !is_digit(b[k])) {
        if (a[i] != b[k]) return a[i] < b[k];
        ++i;
        ++k;
        continue;
      }
      const auto end_a =
          static_cast<std::size_t>(std::find_if_not(a.begin() + i, a.end(), is_digit) - a.begin());
      const auto end_b =
          static_cast<std::size_t>(std::find_if_not(b.begin() + k, b.end(), is_digit) - b.begin());
      const std::string number_a = withoutZeros(a.substr(i, end_a - i)),
                        number_b = withoutZeros(b.substr(k, end_b - k));
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
      i = end_a;
      k = end_b;
    }
    return a.size() - i != b.size() - k ? a.size() - i < b.size() - k : a < b;
  }

 private:
  static std::string withoutZeros(const std::string& digits) {
    const std::size_t first = digits.find_first_not_of('0');
    return first == std::string::npos ? "0" : digits.substr(first);
  }
};

using NamedFiles = std::map<std::string, fs::path, NumbersByValue>;

bool isImage(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm" ||
         extension == ".bmp" || extension == ".tif" || extension == ".tiff";
}

NamedFiles imagesIn(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw std::runtime_error(
        folder.string() +
        ": is not a folder; expected image_0 (left) and image_1 (right) in it, or give --left "
        "and --right with patterns such as 'L*.jpg' and 'R*.jpg'");
  }
  NamedFiles files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && isImage(entry.path()))
      files.emplace(entry.path().stem().string(), entry.path());
  }
  return files;
}

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
    if (entry.is_regular_file() && file.size() > before.size() + after.size() && file.starts_with(before) &&
        file.ends_with(after)) {
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

}  // namespace

ImagePairs pairsInFolder(const fs::path& folder) {
  ImagePairs result = paired(imagesIn(folder / "image_0"), imagesIn(folder / "image_1"));
  if (result.pairs.empty())
    throw std::runtime_error(folder.string() + ": no image in image_0 has the same name as one in image_1");
  return result;
}

ImagePairs pairsByPattern(const fs::path& left, const fs::path& right) {
  ImagePairs result = paired(matching(left), matching(right));
  if (result.pairs.empty()) {
    throw std::runtime_error("no two files form a pair: the text that '*' matches in " + left.string() +
                             " and in " + right.string() + " is never the same");
  }
  return result;
}

cv::Mat readGrey(const fs::path& file) {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) {
    throw std::runtime_error(file.string() +
                             ": cannot be read as an image; remove the pair or copy it again");
  }
  return image;
}

}  // namespace cartvo
