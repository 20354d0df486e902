// KITTI's odometry layout: image_0 and image_1 with numbered images, calib.txt, times.txt.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>

#include "capture/dataset/image_folder_layouts.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

bool isImage(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

std::vector<fs::path> listImages(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (isImage(entry.path())) images.push_back(entry.path());
  }
  if (images.empty()) throw std::runtime_error(folder.string() + " contains no PNG or JPEG image");
  std::sort(images.begin(), images.end());
  return images;
}

/// Reads times.txt, seconds, as ns.
std::vector<std::int64_t> readTimes(const fs::path& file) {
  std::vector<std::int64_t> instants;
  for (const TextLine& line : readLines(file)) {
    const std::optional<long double> seconds = parseNumber<long double>(line.text);
    if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > 1e-9L * kMaxTimestampNs) {
      throw std::runtime_error(fileAndLine(file, line) + "expected one number (seconds) instead of '" +
                               line.text + "'");
    }
    const auto instant_ns = static_cast<std::int64_t>(std::llround(*seconds * 1e9L));
    requireIncreasing(instants, instant_ns, file, line);
    instants.push_back(instant_ns);
  }
  return instants;
}

/// ", the first one missing is 000007.png" if the images are numbered and a number is missing; else "".
std::string firstGapText(const std::vector<fs::path>& images) {
  std::uint64_t next = 0;
  for (const fs::path& image : images) {
    const std::string stem = image.stem().string();
    const std::optional<std::uint64_t> number = parseNumber<std::uint64_t>(stem);
    if (!number) return "";
    if (*number != next) {
      std::string missing = std::to_string(next);
      missing.insert(0, stem.size() - std::min(stem.size(), missing.size()), '0');
      return ", the first one missing is " + missing + image.extension().string();
    }
    ++next;
  }
  return "";
}

ImageSequence readSequence(const fs::path& folder, const fs::path& times) {
  ImageSequence sequence{listImages(folder), readTimes(times)};
  if (sequence.images.size() != sequence.instants_ns.size()) {
    throw std::runtime_error(
        folder.string() + " contains " + std::to_string(sequence.images.size()) + " images, but " +
        times.string() + " has " + std::to_string(sequence.instants_ns.size()) + " instants" +
        (sequence.images.size() < sequence.instants_ns.size() ? firstGapText(sequence.images) : ""));
  }
  return sequence;
}

/// Projection matrix, 3x4, row-major.
using Projection = std::array<double, 12>;

Projection parseProjection(const fs::path& file, const TextLine& line) {
  std::istringstream words(line.text.substr(line.text.find(':') + 1));
  Projection projection{};
  std::string word;
  std::size_t count = 0;
  for (; words >> word; ++count) {
    const std::optional<double> number = parseNumber<double>(word);
    if (!number || !std::isfinite(*number)) {
      throw std::runtime_error(fileAndLine(file, line) + "'" + word + "' is not a number");
    }
    if (count < projection.size()) projection[count] = *number;
  }
  if (count != projection.size()) {
    throw std::runtime_error(fileAndLine(file, line) + "expected 12 numbers (3 rows of 4), found " +
                             std::to_string(count));
  }
  return projection;
}

RectifiedStereo readCalibration(const fs::path& file) {
  std::map<std::string, Projection> projections;
  for (const TextLine& line : readLines(file)) {
    const std::string name = line.text.substr(0, line.text.find(':'));
    if (name == "P0" || name == "P1") projections[name] = parseProjection(file, line);
  }
  if (projections.size() != 2)
    throw std::runtime_error(
        file.string() +
        " must contain the matrices P0: and P1:, each a line of 12 numbers; if they are not "
        "available, remove the file and put a rig.yaml beside it");
  const Projection& left = projections["P0"];
  const Projection& right = projections["P1"];
  constexpr double kTolerance = 1e-6;  // relative
  const double f = left[0];
  if (f <= 0.0 || std::abs(left[5] - f) > kTolerance * f || std::abs(right[0] - f) > kTolerance * f ||
      std::abs(right[5] - f) > kTolerance * f || std::abs(right[6] - left[6]) > kTolerance * f) {
    throw std::runtime_error(
        file.string() +
        ": P0 and P1 are not those of rectified cameras; expected equal focal lengths and equal cy");
  }
  const double baseline = (left[3] - right[3]) / f;  // P1[0,3] = -f b
  if (!std::isfinite(baseline)) {
    throw std::runtime_error(file.string() + ": the baseline from P0 and P1 is not finite");
  }
  if (baseline <= 0.0) {
    throw std::runtime_error(
        file.string() +
        ": P1 places the right camera to the left of the left one; its fourth number must be -f*b");
  }
  return {f, left[2], left[6], right[2], baseline};
}

}  // namespace

bool isKittiFolder(const fs::path& folder) {
  return fs::is_directory(folder / "image_0") && fs::is_directory(folder / "image_1");
}

ImageFolder readKittiFolder(const fs::path& folder) {
  const bool own_times = fs::exists(folder / "times_0.txt") && fs::exists(folder / "times_1.txt");
  if (!own_times && !fs::exists(folder / "times.txt")) {
    throw std::runtime_error(folder.string() +
                             " contains neither times.txt nor both times_0.txt and times_1.txt");
  }
  ImageFolder result;
  result.layout = FolderLayout::kitti;
  result.folder = folder;
  result.left = readSequence(folder / "image_0", folder / (own_times ? "times_0.txt" : "times.txt"));
  result.right = readSequence(folder / "image_1", folder / (own_times ? "times_1.txt" : "times.txt"));
  if (fs::exists(folder / "calib.txt")) {
    result.calib_file = folder / "calib.txt";
    result.rectified = readCalibration(result.calib_file);
  }
  if (fs::exists(folder / "rig.yaml")) result.rig_file = folder / "rig.yaml";
  return result;
}

}  // namespace cartvo::capture
