// Makes recorded image sequences available as content of the simulated cameras.
#include "tools/simulate/sequence_content.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calib/format/kalibr_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "common/image_size.hpp"
#include "tools/simulate/truth.hpp"

namespace cartvo::simulate {
namespace fs = std::filesystem;
namespace {

cv::Size evenSize(cv::Size size) {
  return {size.width / 2 * 2, size.height / 2 * 2};
}

void truncate(capture::ImageSequence& sequence, std::size_t count) {
  sequence.images.resize(count);
  sequence.instants_ns.resize(count);
}

// Number of pairs whose left instant is less than `seconds` after the first; at least 1.
std::size_t countPairsWithin(const capture::ImageSequence& left, double seconds) {
  const std::int64_t end = left.instants_ns.front() + std::llround(seconds * 1e9);
  const auto after = std::lower_bound(left.instants_ns.begin(), left.instants_ns.end(), end);
  return std::max<std::size_t>(1, static_cast<std::size_t>(after - left.instants_ns.begin()));
}

std::string fileSignature(const fs::path& file) {
  return file.filename().string() + " " + std::to_string(fs::file_size(file)) + " " +
         std::to_string(fs::last_write_time(file).time_since_epoch().count());
}

}  // namespace

SequenceContent::SequenceContent(const fs::path& folder, const SequenceSettings& settings)
    : folder_(capture::readImageFolder(folder)), settings_(settings) {
  if (folder_.left.images.empty()) throw std::runtime_error(folder.string() + ": contains no image pair");
  readTruth(folder_.folder / "poses.txt");
  const std::int64_t period = capture::nominalPeriodNs(folder_.left);
  frame_rate_ = period > 0 ? 1e9 / static_cast<double>(period) : 10.0;
  if (settings_.seconds > 0.0) {
    const std::size_t count = countPairsWithin(folder_.left, settings_.seconds);
    truncate(folder_.left, count);
    truncate(folder_.right, count);
    if (!truth_.empty()) truth_.resize(count);
  }
  readRigFor(capture::readGreyImage(folder_.left.images.front()).size());
  truth_ = bodyTrajectory(truth_, rig_);
  for (std::size_t index = 0; index < truth_.size(); ++index) {
    truth_[index].time_ns = leftInstant(static_cast<int>(index));
  }
}

void SequenceContent::readRigFor(cv::Size image_size) {
  if (!folder_.rig_file.empty()) {
    rig_ = calib::readRig(folder_.rig_file);
  } else if (!folder_.calib_file.empty()) {
    rig_ = calib::readRigFiles({folder_.calib_file}, {.image_size = image_size, .cameras = folder_.cameras});
  } else if (!folder_.sensor_files[0].empty() && !folder_.sensor_files[1].empty()) {
    rig_ = calib::readEurocRig(folder_.sensor_files[0], folder_.sensor_files[1]);
  } else {
    throw std::runtime_error(folder_.folder.string() +
                             ": no calibration found; expected calib.txt (KITTI) or rig.yaml");
  }
  if (rig_.left.size != image_size) {
    throw std::runtime_error(folder_.left.images.front().string() + ": " + sizeText(image_size) +
                             " pixels, but the rig file is for " + sizeText(rig_.left.size));
  }
  for (calib::CameraModel* camera : {&rig_.left, &rig_.right}) {
    camera->size = evenSize(camera->size);
    camera->mask = calib::maskOfPart(camera->mask, cv::Rect({}, camera->size));
    // A recorded sequence counts as one of global shutters, as in cartvo replay; a camera's would be unknown.
    camera->readout = camera->readout.value_or(0.0);
  }
}

void SequenceContent::readTruth(const fs::path& poses) {
  if (!fs::exists(poses)) return;
  if (!isKittiTrajectory(poses))
    throw std::runtime_error(poses.string() + ": expected rows of 12 numbers (KITTI)");
  truth_ = readTrajectory(poses);
  if (truth_.size() != folder_.left.images.size()) {
    throw std::runtime_error(poses.string() + ": " + std::to_string(truth_.size()) + " poses for " +
                             std::to_string(folder_.left.images.size()) + " images");
  }
}

std::int64_t SequenceContent::leftInstant(int index) const {
  return folder_.left.instants_ns.at(static_cast<std::size_t>(index)) - folder_.left.instants_ns.front();
}

std::int64_t SequenceContent::rightInstant(int index) const {
  const std::int64_t recorded =
      folder_.right.instants_ns.at(static_cast<std::size_t>(index)) - folder_.left.instants_ns.front();
  return recorded + std::llround(settings_.offset_s * 1e9 +
                                 static_cast<double>(recorded) * settings_.offset_drift_ppm * 1e-6);
}

void SequenceContent::images(int index, cv::Mat& left, cv::Mat& right) const {
  const auto at = static_cast<std::size_t>(index);
  const auto read = [at](const capture::ImageSequence& sequence, cv::Size even) {
    const fs::path& file = sequence.images.at(at);
    const cv::Mat image = capture::readGreyImage(file, sequence.grey_range);
    if (evenSize(image.size()) != even) {
      throw std::runtime_error(file.string() + ": its size differs from that of the first image");
    }
    return image(cv::Rect({0, 0}, even)).clone();
  };
  left = read(folder_.left, rig_.left.size);
  right = read(folder_.right, rig_.right.size);
}

std::string SequenceContent::cacheKey() const {
  std::string key = "sequence behind a blank " + fs::canonical(folder_.folder).string() + "\n";
  for (int index = 0; index < pairCount(); ++index) {
    const auto at = static_cast<std::size_t>(index);
    key += fileSignature(folder_.left.images[at]) + " " + std::to_string(leftInstant(index)) + " " +
           fileSignature(folder_.right.images[at]) + " " + std::to_string(rightInstant(index)) + "\n";
  }
  return key;
}

}  // namespace cartvo::simulate
