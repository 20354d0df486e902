// KITTI's layouts: the odometry sequences (numbered images, calib.txt, times.txt) and the raw recordings.

#include <array>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "capture/dataset/frame_interval.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "capture/dataset/image_instants.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

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
