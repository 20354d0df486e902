// Layout-independent part of reading image folders, and the frame source for one camera.

#include "capture/dataset/image_folder.hpp"

#include <algorithm>
#include <chrono>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "capture/dataset/image_folder_layouts.hpp"
#include "common/ascii_text.hpp"
#include "common/input_file.hpp"
#include "common/printable_text.hpp"
#include "common/statistics.hpp"

namespace cartvo::capture {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxTextBytes = 256U << 20U;

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

/// ": the 16-bit images use 12 bits; their values are divided by 16", or "" if they use 16.
std::string greyRangeText(const GreyRange& range) {
  if (range.used_bits == 16) return "";
  const std::string divided =
      "divided by " + std::to_string(1U << (static_cast<unsigned>(range.used_bits) - 8U));
  if (range.black == 0)
    return ": the 16-bit images use " + std::to_string(range.used_bits) + " bits; their values are " +
           divided;
  return ": the 16-bit images use a small part of their values; " + std::to_string(range.black) +
         " is subtracted, and the rest is " + divided;
}

/// Measures the grey levels of both cameras.
void applyGreyLevels(ImageFolder& folder) {
  constexpr int kDark = 40;  // of 255
  const GreyLevels levels = measureGreyLevels(folder.left.images, folder.right.images);
  folder.left.grey_range = levels.left;
  folder.right.grey_range = levels.right;
  const auto place_of = [](const ImageSequence& sequence) {
    return sequence.images.front().parent_path().string();
  };
  const std::string left_text = greyRangeText(levels.left), right_text = greyRangeText(levels.right);
  if (!left_text.empty()) folder.warnings.push_back(place_of(folder.left) + left_text);
  if (!right_text.empty() && levels.left != levels.right)
    folder.warnings.push_back(place_of(folder.right) + right_text);
  if (levels.largest < kDark) {
    folder.warnings.push_back(place_of(folder.left) +
                              ": the images are dark: the largest value in a sample of them is " +
                              std::to_string(levels.largest) + " of 255");
  }
}

ImageFolder readLists(const std::filesystem::path& folder, const ImageFolderSettings& settings) {
  if (settings.side_by_side) return readSideBySideFolder(folder, settings);
  const std::optional<FolderLayout> layout = detectImageFolder(folder);
  if (!layout) throw std::runtime_error(folder.string() + " is not an image folder. Looked for: " + kLayouts);
  if (*layout == FolderLayout::kitti) return readKittiFolder(folder, settings);
  if (*layout == FolderLayout::one_folder) return readPairFolder(folder, settings);
  if (settings.frame_rate > 0.0) {
    throw std::runtime_error(
        folder.string() +
        ": has the instants of its images; --frame-rate is for videos and for folders of images without "
        "instants, such as image_0 and image_1");
  }
  if (*layout == FolderLayout::kitti_raw) return readKittiRawFolder(folder);
  if (*layout == FolderLayout::lists) return readListFolder(folder);
  return readEurocFolder(*findEurocFolder(folder));
}

}  // namespace

std::optional<FolderLayout> detectImageFolder(const std::filesystem::path& folder) {
  if (isKittiFolder(folder)) return FolderLayout::kitti;
  if (isKittiRawFolder(folder)) return FolderLayout::kitti_raw;
  if (findEurocFolder(folder)) return FolderLayout::euroc;
  if (isListFolder(folder)) return FolderLayout::lists;
  if (findPairFolder(folder)) return FolderLayout::one_folder;
  return std::nullopt;
}

ImageFolder readImageFolder(const std::filesystem::path& folder, const ImageFolderSettings& settings) {
  ImageFolder read = readLists(folder, settings);
  applyGreyLevels(read);
  return read;
}

std::int64_t nominalPeriodNs(const ImageSequence& sequence) {
  if (sequence.instants_ns.size() < 2) return 0;
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < sequence.instants_ns.size(); ++i) {
    intervals.push_back(sequence.instants_ns[i] - sequence.instants_ns[i - 1]);
  }
  return quantile(std::move(intervals), 0.5);
}

std::vector<TextLine> readLines(const std::filesystem::path& file) {
  std::istringstream input(readInputText(file, kMaxTextBytes));
  std::vector<TextLine> lines;
  std::string text;
  for (int number = 1; std::getline(input, text); ++number) {
    const std::string_view content = trimmed(text);
    if (content.empty() || content.front() == '#') continue;
    lines.push_back({number, std::string(content)});
  }
  return lines;
}

std::string fileAndLine(const std::filesystem::path& file, const TextLine& line) {
  return file.string() + ", line " + std::to_string(line.number) + ": ";
}

std::filesystem::path pathIfExists(const std::filesystem::path& file) {
  return std::filesystem::exists(file) ? file : std::filesystem::path();
}

void requireIncreasing(const std::vector<std::int64_t>& previous, std::int64_t instant_ns,
                       const std::filesystem::path& file, const TextLine& line) {
  if (previous.empty() || instant_ns > previous.back()) return;
  throw std::runtime_error(fileAndLine(file, line) +
                           (instant_ns == previous.back()
                                ? "the instant is that of the previous line again"
                                : "the instant is earlier than that of the previous line") +
                           "; expected instants that increase; found '" + printableExcerpt(line.text) + "'");
}

void requireInstantForEachImage(const ImageSequence& sequence, const std::filesystem::path& folder,
                                const std::filesystem::path& times) {
  const std::size_t images = sequence.images.size(), instants = sequence.instants_ns.size();
  if (images == instants) return;
  throw std::runtime_error(folder.string() + " contains " + std::to_string(images) + " images, but " +
                           times.string() + " has " + std::to_string(instants) + " instants" +
                           (images < instants ? firstGapText(sequence.images) : ""));
}

ImageSequenceSource::ImageSequenceSource(ImageSequence sequence) : sequence_(std::move(sequence)) {
  if (sequence_.images.size() != sequence_.instants_ns.size()) {
    throw std::invalid_argument("an image sequence needs an instant for each image");
  }
}

ReadOutcome ImageSequenceSource::read(Frame& frame, std::chrono::milliseconds /*timeout*/) {
  const std::uint64_t index = next_;
  if (interrupted_ || index >= sequence_.images.size()) return ReadOutcome::ended;
  const std::filesystem::path& file = sequence_.images[index];
  Frame read;
  read.image = partOf(readGreyImage(file, sequence_.grey_range), sequence_.part);
  if (size_.empty()) size_ = read.image.size();
  if (read.image.size() != size_) {
    throw std::runtime_error(file.string() + " is " + std::to_string(read.image.cols) + "x" +
                             std::to_string(read.image.rows) + ", but the previous images are " +
                             std::to_string(size_.width) + "x" + std::to_string(size_.height));
  }
  read.exposure_ns = sequence_.instants_ns[index];
  read.exposure_stddev_ns = sequence_.stddev_ns;
  read.arrival_ns = read.exposure_ns;
  read.decoded_ns = read.exposure_ns;
  read.sequence = index;
  read.instant_source = InstantSource::file;
  frame = std::move(read);
  ++next_;
  return ReadOutcome::frame;
}

CameraHealth ImageSequenceSource::health() const {
  CameraHealth health;
  health.frames = next_;
  const bool ended = interrupted_ || health.frames >= sequence_.images.size();
  health.state = ended ? CameraState::ended : CameraState::streaming;
  return health;
}

}  // namespace cartvo::capture
