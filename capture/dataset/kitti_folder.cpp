// KITTI's layouts: the odometry sequences (numbered images, calib.txt, times.txt) and the raw recordings.

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "capture/dataset/frame_interval.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// Reads times.txt, seconds, as ns.
std::vector<std::int64_t> readTimes(const fs::path& file) {
  std::vector<std::int64_t> instants;
  for (const TextLine& line : readLines(file)) {
    const std::optional<long double> seconds = parseNumber<long double>(line.text);
    if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > 1e-9L * kMaxTimestampNs) {
      throw std::runtime_error(fileAndLine(file, line) + "expected one number (seconds) instead of '" +
                               printableExcerpt(line.text) + "'");
    }
    const auto instant_ns = static_cast<std::int64_t>(std::llround(*seconds * 1e9L));
    requireIncreasing(instants, instant_ns, file, line);
    instants.push_back(instant_ns);
  }
  requirePlausibleInterval(instants, file, TimeUnit::seconds);
  return instants;
}

/// "FILE has no partner among the right images (3 in all)" for the images of one side without a partner.
std::string unpairedText(const std::vector<fs::path>& images, const char* other_side) {
  const std::string count =
      images.size() == 1 ? "" : " (nor have " + std::to_string(images.size() - 1) + " more)";
  return images.front().string() + " has no partner among the " + other_side + " images" + count;
}

/// Orders the right images as their left partners. Throws std::runtime_error naming images of one side that
/// the other side does not have.
void matchByName(ImageFolder& folder) {
  const NamedPairs named = pairByName(folder.left.images, folder.right.images);
  std::string message;
  if (!named.left_only.empty()) message = unpairedText(named.left_only, "right");
  if (!named.right_only.empty())
    message += (message.empty() ? "" : ", and ") + unpairedText(named.right_only, "left");
  if (!message.empty()) {
    throw std::runtime_error(
        message +
        ". Left and right images belong together by their names: copy what is missing, or "
        "give each camera's instants in times_0.txt and times_1.txt");
  }
  std::transform(named.pairs.begin(), named.pairs.end(), folder.right.images.begin(),
                 [](const NamedPairs::Pair& pair) { return pair.right; });
}

/// The number in the name of an image; nothing if the name is not a number.
std::optional<std::int64_t> numberOf(const fs::path& image) {
  const std::string name = image.stem().string();
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  const auto number = parseNumber<std::int64_t>(std::string_view(name).substr(digits));
  constexpr std::int64_t kMaxNumber = 1'000'000'000;
  return number && *number <= kMaxNumber ? number : std::nullopt;
}

/// Instants of images at a frame rate (Hz), by the numbers in their names, or by their places if these
/// numbers do not increase.
std::vector<std::int64_t> instantsAtRate(const std::vector<fs::path>& images, double frame_rate) {
  std::vector<std::int64_t> numbers;
  for (const fs::path& image : images) {
    const std::optional<std::int64_t> number = numberOf(image);
    if (number && (numbers.empty() || *number > numbers.back())) numbers.push_back(*number);
  }
  const bool are_numbered = numbers.size() == images.size();
  std::vector<std::int64_t> instants;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto frame = are_numbered ? numbers[i] - numbers.front() : static_cast<std::int64_t>(i);
    instants.push_back(std::llround(1e9 * static_cast<double>(frame) / frame_rate));
  }
  return instants;
}

struct TimesFiles {
  fs::path left, right;
  bool areShared() const { return left == right; }
};

TimesFiles findTimes(const fs::path& folder) {
  TimesFiles own{folder / "times_0.txt", folder / "times_1.txt"};
  if (fs::exists(own.left) && fs::exists(own.right)) return own;
  if (fs::exists(folder / "times.txt")) return {folder / "times.txt", folder / "times.txt"};
  throw std::runtime_error(
      folder.string() +
      " contains neither times.txt nor both times_0.txt and times_1.txt, with the instant "
      "of each image in seconds; at a fixed rate give --frame-rate HZ instead");
}

void readInstants(ImageFolder& folder, const ImageSubfolders& images, const ImageFolderSettings& settings) {
  if (settings.frame_rate > 0.0) {
    matchByName(folder);
    folder.left.instants_ns = folder.right.instants_ns =
        instantsAtRate(folder.left.images, settings.frame_rate);
    return;
  }
  const TimesFiles times = findTimes(folder.folder);
  folder.left.instants_ns = readTimes(times.left);
  folder.right.instants_ns = times.areShared() ? folder.left.instants_ns : readTimes(times.right);
  if (times.areShared()) matchByName(folder);
  requireInstantForEachImage(folder.left, images.left, times.left);
  requireInstantForEachImage(folder.right, images.right, times.right);
  if (const std::string warning = frameNumberWarning(folder.left.instants_ns, times.left); !warning.empty())
    folder.warnings.push_back(warning);
}

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

ImageSequence readRawCamera(const fs::path& folder) {
  const fs::path file = folder / "timestamps.txt";
  ImageSequence sequence;
  sequence.images = listImages(folder / "data");
  for (const TextLine& line : readLines(file)) {
    const std::optional<std::int64_t> instant_ns = parseDateAndTime(line.text);
    if (!instant_ns) {
      throw std::runtime_error(
          fileAndLine(file, line) +
          "expected a date and a time such as 2011-09-26 13:02:25.594360375 instead of '" +
          printableExcerpt(line.text) + "'");
    }
    requireIncreasing(sequence.instants_ns, *instant_ns, file, line);
    sequence.instants_ns.push_back(*instant_ns);
  }
  requirePlausibleInterval(sequence.instants_ns, file, TimeUnit::seconds);
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
  readInstants(result, images, settings);
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
