// Lists of images with their instants, one for each camera.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "capture/dataset/frame_interval.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

/// Nanoseconds for an integer of 16 or more digits, else seconds.
TimeUnit unitOf(const std::string& text) {
  constexpr std::size_t kMinNanosecondDigits = 16;
  const bool is_integer = text.find_first_not_of("0123456789") == std::string::npos;
  return is_integer && text.size() >= kMinNanosecondDigits ? TimeUnit::nanoseconds : TimeUnit::seconds;
}

/// Parses an instant as ns.
std::optional<std::int64_t> parseInstant(const std::string& text) {
  if (unitOf(text) == TimeUnit::nanoseconds) {
    const auto nanoseconds = parseNumber<std::int64_t>(text);
    return nanoseconds && *nanoseconds <= kMaxTimestampNs ? nanoseconds : std::nullopt;
  }
  const auto seconds = parseNumber<long double>(text);
  if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > 1e-9L * kMaxTimestampNs)
    return std::nullopt;
  return static_cast<std::int64_t>(std::llround(*seconds * 1e9L));
}

/// A relative path that does not leave its folder.
bool staysInside(const fs::path& path) {
  return path.is_relative() && std::find(path.begin(), path.end(), "..") == path.end();
}

ImageSequence readList(const fs::path& file) {
  ImageSequence sequence;
  TimeUnit unit = TimeUnit::seconds;
  for (const TextLine& line : readLines(file)) {
    const std::size_t end = line.text.find_first_of(" \t,");
    const std::size_t begin = line.text.find_first_not_of(" \t,", end);
    const std::string instant = line.text.substr(0, end);
    const auto instant_ns = parseInstant(instant);
    unit = unitOf(instant);
    if (!instant_ns || begin == std::string::npos) {
      throw std::runtime_error(fileAndLine(file, line) +
                               "expected an instant (seconds, or ns of 16 or more digits) and an image file "
                               "instead of '" +
                               printableExcerpt(line.text) + "'");
    }
    const fs::path name = line.text.substr(begin);
    if (!staysInside(name)) {
      throw std::runtime_error(fileAndLine(file, line) + "'" + printableExcerpt(name.string()) +
                               "' must be a path in the folder of the list");
    }
    requireIncreasing(sequence.instants_ns, *instant_ns, file, line);
    sequence.images.push_back(file.parent_path() / name);
    if (!fs::exists(sequence.images.back()))
      throw std::runtime_error(fileAndLine(file, line) + sequence.images.back().string() + " is missing");
    sequence.instants_ns.push_back(*instant_ns);
  }
  if (sequence.images.empty()) throw std::runtime_error(file.string() + " lists no image");
  requirePlausibleInterval(sequence.instants_ns, file, unit);
  return sequence;
}

/// The lists of both cameras; nothing if there are none.
std::optional<std::pair<fs::path, fs::path>> findLists(const fs::path& folder) {
  static constexpr std::array<std::pair<const char*, const char*>, 2> kNames{
      {{"left.txt", "right.txt"}, {"cam0.txt", "cam1.txt"}}};
  for (const auto& [left, right] : kNames) {
    if (fs::is_regular_file(folder / left) && fs::is_regular_file(folder / right))
      return std::pair(folder / left, folder / right);
  }
  return std::nullopt;
}

}  // namespace

bool isListFolder(const fs::path& folder) {
  return findLists(folder).has_value();
}

ImageFolder readListFolder(const fs::path& folder) {
  const auto [left, right] = *findLists(folder);
  ImageFolder result;
  result.layout = FolderLayout::lists;
  result.folder = folder;
  result.left = readList(left);
  result.right = readList(right);
  result.calib_file = pathIfExists(folder / "calib.txt");
  result.rig_file = pathIfExists(folder / "rig.yaml");
  return result;
}

}  // namespace cartvo::capture
