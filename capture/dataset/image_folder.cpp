// Layout-independent part of reading image folders, and the frame source for one camera.

#include "capture/dataset/image_folder.hpp"

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <opencv2/imgcodecs.hpp>

#include "capture/dataset/image_folder_layouts.hpp"
#include "common/statistics.hpp"

namespace cartvo::capture {

std::optional<FolderLayout> detectImageFolder(const std::filesystem::path& folder) {
  if (isKittiFolder(folder)) return FolderLayout::kitti;
  if (findEurocFolder(folder)) return FolderLayout::euroc;
  return std::nullopt;
}

ImageFolder readImageFolder(const std::filesystem::path& folder) {
  if (isKittiFolder(folder)) return readKittiFolder(folder);
  if (const auto euroc = findEurocFolder(folder)) return readEurocFolder(*euroc);
  throw std::runtime_error(
      folder.string() +
      " is not an image folder: it contains neither image_0 and image_1 (KITTI's layout) nor "
      "mav0/cam0 and mav0/cam1 (EuRoC's)");
}

cv::Mat readGreyImage(const std::filesystem::path& file) {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) {
    throw std::runtime_error(
        file.string() +
        ": cannot be decoded as an image; expected a complete PNG or JPEG file; copy it again");
  }
  return image;
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
  std::ifstream input(file);
  if (!input) throw std::runtime_error("cannot read " + file.string());
  std::vector<TextLine> lines;
  std::string text;
  for (int number = 1; std::getline(input, text); ++number) {
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (begin == std::string::npos || text[begin] == '#') continue;
    lines.push_back({number, text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1)});
  }
  return lines;
}

std::string fileAndLine(const std::filesystem::path& file, const TextLine& line) {
  return file.string() + ", line " + std::to_string(line.number) + ": ";
}

void requireIncreasing(const std::vector<std::int64_t>& previous, std::int64_t instant_ns,
                       const std::filesystem::path& file, const TextLine& line) {
  if (previous.empty() || instant_ns > previous.back()) return;
  throw std::runtime_error(fileAndLine(file, line) + "the instant is not later than the previous one");
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
  read.image = readGreyImage(file);
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
