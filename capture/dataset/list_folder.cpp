// Folders of images with their instants: lists for each camera, EuRoC and KITTI.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "capture/dataset/image_folder_layouts.hpp"
#include "capture/dataset/image_instants.hpp"
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

namespace fs = std::filesystem;

ImageSequence readCamera(const fs::path& folder) {
  const fs::path file = folder / "data.csv";
  ImageSequence sequence;
  for (const TextLine& line : readLines(file)) {
    const bool is_header =
        line.number == 1 && std::isalpha(static_cast<unsigned char>(line.text.front())) != 0;
    if (is_header) continue;
    const std::size_t comma = line.text.find(',');
    const auto instant_ns = parseNumber<std::int64_t>(line.text.substr(0, comma));
    std::string name = comma == std::string::npos ? "" : line.text.substr(comma + 1);
    name.erase(0, name.find_first_not_of(" \t"));
    const bool is_instant = instant_ns && *instant_ns >= -kMaxTimestampNs && *instant_ns <= kMaxTimestampNs;
    if (!is_instant || name.empty()) {
      throw std::runtime_error(fileAndLine(file, line) + "expected 'instant in ns,file name' instead of '" +
                               printableExcerpt(line.text) + "'");
    }
    if (fs::path(name).filename() != name) {
      throw std::runtime_error(fileAndLine(file, line) + "'" + printableExcerpt(name) +
                               "' must be the name of a file in data/");
    }
    requireIncreasing(sequence.instants_ns, *instant_ns, file, line);
    const fs::path image = folder / "data" / name;
    if (!fs::exists(image))
      throw std::runtime_error(fileAndLine(file, line) + image.string() + " is missing");
    sequence.instants_ns.push_back(*instant_ns);
    sequence.images.push_back(image);
  }
  if (sequence.images.empty()) throw std::runtime_error(file.string() + " lists no image");
  requirePlausibleInterval(sequence.instants_ns, file, TimeUnit::nanoseconds);
  return sequence;
}

// Instants of KITTI's raw recordings.

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// Parses "2011-09-26 13:02:25.594360375" (UTC) as ns since 1970.
std::optional<std::int64_t> parseDateAndTime(const std::string& text) {
  std::tm calendar{};
  const char* const end = strptime(text.c_str(), "%Y-%m-%d %H:%M:%S", &calendar);
  if (end == nullptr) return std::nullopt;
  const std::int64_t seconds = timegm(&calendar);
  constexpr std::int64_t kMaxSeconds = kMaxTimestampNs / kNanosecondsPerSecond;
  if (seconds < -kMaxSeconds || seconds >= kMaxSeconds) return std::nullopt;
  std::string decimals(end);
  if (!decimals.empty() && decimals.front() != '.') return std::nullopt;
  decimals = decimals.empty() ? "0" : decimals.substr(1, 9);
  decimals.resize(9, '0');
  const auto fraction = parseNumber<std::int64_t>(decimals);
  return fraction && *fraction >= 0 ? std::optional(seconds * kNanosecondsPerSecond + *fraction)
                                    : std::nullopt;
}

/// Reads a file of KITTI's raw recordings, timestamps.txt, with a date and a time (UTC) in each line, such as
/// 2011-09-26 13:02:25.594360375, as ns since the Unix epoch. Throws std::runtime_error naming file and line
/// if one is not of this form, the instants do not increase, or their intervals are not those of a camera.
std::vector<std::int64_t> readDatesAndTimes(const std::filesystem::path& file) {
  std::vector<std::int64_t> instants;
  for (const TextLine& line : readLines(file)) {
    const std::optional<std::int64_t> instant_ns = parseDateAndTime(line.text);
    if (!instant_ns) {
      throw std::runtime_error(
          fileAndLine(file, line) +
          "expected a date and a time such as 2011-09-26 13:02:25.594360375 instead of '" +
          printableExcerpt(line.text) + "'");
    }
    requireIncreasing(instants, *instant_ns, file, line);
    instants.push_back(*instant_ns);
  }
  requirePlausibleInterval(instants, file, TimeUnit::seconds);
  return instants;
}

namespace fs = std::filesystem;

ImageSequence readRawCamera(const fs::path& folder) {
  const fs::path file = folder / "timestamps.txt";
  ImageSequence sequence;
  sequence.images = listImages(folder / "data");
  sequence.instants_ns = readDatesAndTimes(file);
  requireInstantForEachImage(sequence, folder / "data", file);
  return sequence;
}

/// The cameras of a raw recording: the grey ones, else the coloured ones; nothing if it has neither pair.
std::optional<std::array<int, 2>> rawCameras(const fs::path& folder) {
  for (const std::array<int, 2> cameras : {std::array{0, 1}, std::array{2, 3}}) {
    const auto has = [&](int camera) {
      return fs::is_directory(folder / ("image_0" + std::to_string(camera)) / "data");
    };
    if (has(cameras[0]) && has(cameras[1])) return cameras;
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

std::optional<fs::path> findEurocFolder(const fs::path& folder) {
  for (const fs::path& candidate : {folder, folder / "mav0"}) {
    if (fs::is_directory(candidate / "cam0") && fs::is_directory(candidate / "cam1")) return candidate;
  }
  return std::nullopt;
}

ImageFolder readEurocFolder(const fs::path& folder) {
  ImageFolder result;
  result.layout = FolderLayout::euroc;
  result.folder = folder;
  result.left = readCamera(folder / "cam0");
  result.right = readCamera(folder / "cam1");
  result.sensor_files = {pathIfExists(folder / "cam0/sensor.yaml"),
                         pathIfExists(folder / "cam1/sensor.yaml")};
  for (const fs::path& place : {folder, folder.parent_path()}) {
    for (const char* name : {"camchain.yaml", "dso/camchain.yaml"})
      if (result.calib_file.empty()) result.calib_file = pathIfExists(place / name);
  }
  result.rig_file = pathIfExists(folder / "rig.yaml");
  if (result.rig_file.empty()) result.rig_file = pathIfExists(folder.parent_path() / "rig.yaml");
  return result;
}

bool isKittiFolder(const fs::path& folder) {
  return !findImageSubfolders(folder).left.empty();
}

ImageFolder readKittiFolder(const fs::path& folder, const ImageFolderSettings& settings) {
  const ImageSubfolders images = findImageSubfolders(folder);
  ImageFolder result;
  result.layout = FolderLayout::kitti;
  result.folder = folder;
  if (images.is_colour) result.cameras = {2, 3};
  result.left.images = listImages(images.left);
  result.right.images = listImages(images.right);
  readInstants(result, {folder}, settings.frame_rate);
  result.calib_file = pathIfExists(folder / "calib.txt");
  result.rig_file = pathIfExists(folder / "rig.yaml");
  return result;
}

bool isKittiRawFolder(const fs::path& folder) {
  return rawCameras(folder).has_value();
}

ImageFolder readKittiRawFolder(const fs::path& folder) {
  ImageFolder result;
  result.layout = FolderLayout::kitti_raw;
  result.folder = folder;
  result.cameras = *rawCameras(folder);
  const auto camera_folder = [&](int camera) { return folder / ("image_0" + std::to_string(camera)); };
  result.left = readRawCamera(camera_folder(result.cameras[0]));
  result.right = readRawCamera(camera_folder(result.cameras[1]));
  // The calibration of a day lies beside its drives.
  for (const fs::path& place : {folder, fs::absolute(folder).lexically_normal().parent_path()}) {
    if (result.calib_file.empty()) result.calib_file = pathIfExists(place / "calib_cam_to_cam.txt");
  }
  result.rig_file = pathIfExists(folder / "rig.yaml");
  return result;
}

}  // namespace cartvo::capture
