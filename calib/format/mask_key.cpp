// Reading and writing of masks: PNG files, embedded PNG, polygons.
#include "calib/format/mask_key.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/base64.hpp"
#include "common/image_size.hpp"
#include "common/input_file.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPolygons = 100, kMaxPoints = 100;  // of a mask, of a polygon
constexpr std::uintmax_t kMaxPngBytes = 256U << 10U;         // a painted mask of 8192x8192 px has less
constexpr std::size_t kMaxEmbeddedCharacters = 1U << 20U;
constexpr double kUsedGrey = 128.0;
constexpr std::string_view kEmbedded = "data:image/png;base64,";
constexpr const char* kForms =
    "the name of a PNG file, or polygons [[[x, y], [x, y], [x, y]], ...] in px of the raw picture";

/// Size in the header of a PNG, so that nothing of another size is decoded; empty if it is no PNG.
cv::Size pngSize(std::string_view png) {
  constexpr std::string_view kStart("\x89PNG\r\n\x1A\n\0\0\0\rIHDR", 16);
  constexpr std::size_t kWidthAt = 16, kHeightAt = 20, kEnd = 24;
  if (!png.starts_with(kStart) || png.size() < kEnd) return {};
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value << 8U | static_cast<std::uint8_t>(png[at + i]);
    return static_cast<int>(value & 0x7FFFFFFFU);
  };
  return {number(kWidthAt), number(kHeightAt)};
}

/// Decodes a PNG as grey; empty if it is damaged.
cv::Mat decodePng(std::string_view png) {
  const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8UC1, const_cast<char*>(png.data()));
  try {
    return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    return {};
  }
}

/// `source`: what the PNG is, for errors.
StaticMask maskOfPng(const StrictYaml& yaml, std::string_view png, cv::Size size, const std::string& source) {
  const cv::Size png_size = pngSize(png);
  if (png_size.empty()) yaml.fail(source + " is not a PNG; expected " + kForms);
  if (png_size != size) {
    yaml.fail(source + " is " + sizeText(png_size) + " px, but the camera's pictures are " + sizeText(size) +
              " (image_size): draw the mask over a raw picture of this camera");
  }
  const cv::Mat grey = decodePng(png);
  if (grey.size() != size) yaml.fail(source + " is a damaged PNG");
  StaticMask mask;
  cv::threshold(grey, mask.used, kUsedGrey - 1.0, 255.0, cv::THRESH_BINARY);
  return mask;
}

StaticMask maskOfFile(const StrictYaml& yaml, const std::string& name, cv::Size size,
                      const fs::path& folder) {
  const fs::path file = folder / name;
  std::string png;
  try {
    png = readInputFile(file, kMaxPngBytes);
  } catch (const std::runtime_error& error) {
    yaml.fail(std::string(error.what()) + "; expected " + kForms);
  }
  StaticMask mask = maskOfPng(yaml, png, size, file.string());
  mask.file = file;
  return mask;
}

StaticMask maskOfEmbedded(const StrictYaml& yaml, std::string_view text, cv::Size size) {
  constexpr const char* kSource = "the embedded picture";
  text.remove_prefix(kEmbedded.size());
  if (text.size() > kMaxEmbeddedCharacters) yaml.fail(std::string(kSource) + " is larger than 768 KiB");
  const auto png = decodeBase64(text);
  if (!png) yaml.fail(std::string(kSource) + " is not base64");
  return maskOfPng(yaml, *png, size, kSource);
}

StaticMask::Polygon readPolygon(const StrictYaml& yaml, cv::Size size) {
  const std::string expected = "a polygon of 3 to " + std::to_string(kMaxPoints) +
                               " points [x, y], whole numbers from 0 to " + std::to_string(size.width) +
                               " and from 0 to " + std::to_string(size.height) + " px";
  StaticMask::Polygon polygon;
  for (const StrictYaml& point : yaml.items(kMaxPoints, expected)) {
    if (!point.isSequence()) point.failExpecting(expected);
    const std::vector<double> numbers = point.numbers();
    const auto is_whole = [](double value, int max) {
      return value >= 0.0 && value <= max && value == std::floor(value);
    };
    if (numbers.size() != 2 || !is_whole(numbers[0], size.width) || !is_whole(numbers[1], size.height))
      point.failExpecting(expected);
    polygon.emplace_back(static_cast<int>(numbers[0]), static_cast<int>(numbers[1]));
  }
  if (polygon.size() < 3) yaml.failExpecting(expected);
  return polygon;
}

StaticMask readAnyMask(const StrictYaml& yaml, cv::Size size, const std::optional<fs::path>& folder) {
  if (yaml.isSequence()) {
    std::vector<StaticMask::Polygon> polygons;
    for (const StrictYaml& polygon :
         yaml.items(kMaxPolygons, "at most " + std::to_string(kMaxPolygons) + " polygons"))
      polygons.push_back(readPolygon(polygon, size));
    if (polygons.empty()) yaml.failExpecting(kForms);
    return maskOfPolygons(std::move(polygons), size);
  }
  if (!yaml.isText()) yaml.failExpecting(kForms);
  const std::string text = yaml.text();
  if (text.starts_with(kEmbedded)) return maskOfEmbedded(yaml, text, size);
  if (!folder) yaml.failExpecting("polygons or an embedded picture: the text of a recording names no files");
  return maskOfFile(yaml, text, size, *folder);
}

std::string polygonsText(const std::vector<StaticMask::Polygon>& polygons) {
  std::string text = "[";
  for (const StaticMask::Polygon& polygon : polygons) {
    text += text.size() > 1 ? ",\n    [" : "\n    [";
    for (const cv::Point& point : polygon) {
      if (!text.ends_with('[')) text += ", ";
      text.append("[").append(std::to_string(point.x)).append(", ").append(std::to_string(point.y)) += ']';
    }
    text += ']';
  }
  text += ']';
  return text;
}

/// Name of the file from a folder: relative if it is in or below the folder.
std::string nameFrom(const fs::path& folder, const fs::path& file) {
  const fs::path whole = fs::absolute(file).lexically_normal();
  const fs::path relative = whole.lexically_relative(fs::absolute(folder).lexically_normal());
  return relative.empty() || *relative.begin() == ".." ? whole.string() : relative.string();
}

}  // namespace

StaticMask readMask(const StrictYaml& yaml, cv::Size size, const std::optional<fs::path>& folder) {
  StaticMask mask = readAnyMask(yaml, size, folder);
  if (const double share = maskedShare(mask); share > kMaxMaskedShare) {
    yaml.fail("masks " + std::to_string(std::lround(100.0 * share)) + " % of the picture, expected at most " +
              std::to_string(std::lround(100.0 * kMaxMaskedShare)) +
              " %: black is not used; are black and white exchanged?");
  }
  return mask;
}

std::string maskText(const StaticMask& mask, const std::optional<fs::path>& folder) {
  if (!mask.polygons.empty()) return polygonsText(mask.polygons);
  if (folder && !mask.file.empty()) return quotedYaml(nameFrom(*folder, mask.file));
  return quotedYaml(std::string(kEmbedded) + encodeBase64(maskPng(mask)));
}

std::string maskPng(const StaticMask& mask) {
  std::vector<std::uint8_t> png;
  const std::vector<int> smallest{cv::IMWRITE_PNG_BILEVEL,     1,
                                  cv::IMWRITE_PNG_COMPRESSION, 9,
                                  cv::IMWRITE_PNG_STRATEGY,    cv::IMWRITE_PNG_STRATEGY_DEFAULT};
  if (!cv::imencode(".png", mask.used, png, smallest)) throw std::runtime_error("a mask cannot be encoded");
  return {png.begin(), png.end()};
}

}  // namespace cartvo::calib
