// Disturbances by choosing image files, by changing images and by changing the rig.
#include "tools/benchmark/robustness/disturbance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "capture/dataset/image_folder.hpp"
#include "common/units.hpp"
#include "tools/benchmark/chosen_images.hpp"
#include "tools/benchmark/offset/alternate_frames.hpp"
#include "tools/benchmark/robustness/jumps.hpp"

namespace cartvo::benchmark {
namespace {

/// Those of the indices 0 to count - 1 for which keep(i) holds; always the first.
Indices indicesWhere(std::size_t count, const std::function<bool(std::size_t)>& keep) {
  Indices indices;
  for (std::size_t i = 0; i < count; ++i)
    if (i == 0 || keep(i)) indices.push_back(i);
  return indices;
}

/// A second of every four is lost.
bool isBetweenBursts(const capture::ImageSequence& left, std::size_t i) {
  const double since = 1e-9 * static_cast<double>(left.instants_ns[i] - left.instants_ns.front());
  return static_cast<int>(since) % 4 != 3;
}

/// The pairs that are not lost.
Indices keptPairs(const std::string& disturbance, const capture::ImageSequence& left) {
  std::mt19937_64 random(7);
  const auto lose = [&](double share) {
    return indicesWhere(left.images.size(), [&](std::size_t) {
      return static_cast<double>(random() >> 11) * 0x1.0p-53 >= share;
    });
  };
  const auto every = [&](std::size_t step) {
    return indicesWhere(left.images.size(), [&](std::size_t i) { return i % step == 0; });
  };
  if (disturbance == "lose10") return lose(0.1);
  if (disturbance == "lose20") return lose(0.2);
  if (disturbance == "lose30") return lose(0.3);
  if (disturbance == "every2") return every(2);
  if (disturbance == "every3") return every(3);
  if (disturbance == "bursts")
    return indicesWhere(left.images.size(), [&](std::size_t i) { return isBetweenBursts(left, i); });
  return every(1);
}

// Changes of a picture. `left`: whether it is the left camera's; `number` counts its frames.

/// Date, time and the name of the camera, as cameras write them into their pictures.
void writeText(cv::Mat& image, std::uint64_t number) {
  const double scale = image.cols / 680.0;
  const auto put = [&](const std::string& text, cv::Point at) {
    for (const auto& [grey, thickness] : {std::pair(0, 4), std::pair(255, 2)})
      cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.9 * scale, cv::Scalar(grey),
                  std::max(1, static_cast<int>(thickness * scale)), cv::LINE_8);
  };
  const std::uint64_t second = number / 18 % 60;
  put("2026-11-26 Thu 10:42:" + std::to_string(10 + second % 50),
      {static_cast<int>(12 * scale), image.rows / 12});
  put("Camera 01", {image.cols * 2 / 3, image.rows - image.rows / 25});
}

/// Part of the cart at the lower edge of the picture, a metre before the cameras.
void coverByCart(cv::Mat& image, bool left) {
  const int height = image.rows * 15 / 100, disparity = left ? 0 : image.cols * 8 / 100;
  cv::Mat texture(height, image.cols * 2, CV_8UC1);
  cv::RNG random(7);
  random.fill(texture, cv::RNG::NORMAL, 90.0, 120.0);
  cv::GaussianBlur(texture, texture, {}, 2.0);
  texture(cv::Rect(disparity, 0, image.cols, height)).copyTo(image.rowRange(image.rows - height, image.rows));
}

/// A third of the contrast, as behind a wet lens.
void reduceContrast(cv::Mat& image) {
  image.convertTo(image, -1, 1.0 / 3.0, 85.0);
}

using PictureChange = std::function<void(cv::Mat& image, bool left, const capture::Frame& frame)>;

PictureChange pictureChange(const std::string& disturbance) {
  if (disturbance == "text")
    return [](cv::Mat& image, bool, const capture::Frame& frame) { writeText(image, frame.sequence); };
  if (disturbance == "strip")
    return [](cv::Mat& image, bool left, const capture::Frame&) { coverByCart(image, left); };
  if (disturbance == "contrast")
    return [](cv::Mat& image, bool, const capture::Frame&) { reduceContrast(image); };
  throw std::logic_error("no picture change named " + disturbance);
}

/// A camera whose pictures are changed.
class ChangedSource final : public capture::CameraSource {
 public:
  ChangedSource(std::unique_ptr<capture::CameraSource> camera, PictureChange change, bool left)
      : camera_(std::move(camera)), change_(std::move(change)), left_(left) {}

  capture::ReadOutcome read(capture::Frame& frame, std::chrono::milliseconds timeout) override {
    const capture::ReadOutcome outcome = camera_->read(frame, timeout);
    if (outcome != capture::ReadOutcome::frame) return outcome;
    cv::Mat image = frame.image.clone();
    change_(image, left_, frame);
    frame.image = image;
    return outcome;
  }
  capture::CameraHealth health() const override { return camera_->health(); }
  void interrupt() noexcept override { camera_->interrupt(); }

 private:
  std::unique_ptr<capture::CameraSource> camera_;
  PictureChange change_;
  bool left_;
};

void changePictures(capture::StereoSource& source, const PictureChange& change) {
  source.left = std::make_unique<ChangedSource>(std::move(source.left), change, true);
  source.right = std::make_unique<ChangedSource>(std::move(source.right), change, false);
}

void addJumps(const std::string& disturbance, std::int64_t first_ns, DisturbedSequence& result) {
  const Eigen::Vector3d axis =
      disturbance == "pitch-jumps" ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Jumps jumps = jumpsOf(result.rig.rig, result.truth.left_camera, first_ns, axis);
  changePictures(result.source,
                 [turned = jumps.turned](cv::Mat& image, bool left, const capture::Frame& frame) {
                   image = turned(image, left, frame.exposure_ns);
                 });
  result.rig.rig = jumps.rig;
  result.truth = {jumps.truth, {}, true};
}

/// Exchanges image files, or turns the right camera of the rig.
void applyRigFault(const std::string& disturbance, const capture::ImageFolder& images,
                   DisturbedSequence& result) {
  capture::ImageSequence left = images.left, right = images.right;
  if (disturbance == "swapped") {
    std::swap(left.images, right.images);
  } else if (disturbance == "twice") {
    right.images = left.images;
  } else if (disturbance == "wrong-stamps") {
    right.images.erase(right.images.begin());
    right.instants_ns.pop_back();
  } else {  // the rig of two other cameras: 2 degrees of yaw, 1.2 of pitch, half the baseline
    Eigen::Isometry3d& T_right_left = result.rig.rig.T_right_left;
    const Eigen::AngleAxisd yaw(2.0 * kRadiansPerDegree, Eigen::Vector3d::UnitY());
    const Eigen::AngleAxisd pitch(1.2 * kRadiansPerDegree, Eigen::Vector3d::UnitX());
    T_right_left.linear() = (yaw * pitch).toRotationMatrix() * T_right_left.linear();
    T_right_left.translation() *= 0.5;
  }
  result.source.left = std::make_unique<capture::ImageSequenceSource>(left);
  result.source.right = std::make_unique<capture::ImageSequenceSource>(right);
}

}  // namespace

const std::vector<Disturbance>& allDisturbances() {
  using enum DisturbanceKind;
  static const std::vector<Disturbance> all{
      {"none", "the sequence as it is", none},
      {"lose10", "10 % of the pairs are lost at random", pairs},
      {"lose20", "20 %", pairs},
      {"lose30", "30 %", pairs},
      {"bursts", "a second of every four is lost", pairs},
      {"every2", "only every second pair", pairs},
      {"every3", "only every third pair", pairs},
      {"text", "date and name are written into the pictures", picture},
      {"strip", "the cart covers 15 % of the pictures", picture},
      {"contrast", "a third of the contrast", picture},
      {"pitch-jumps", "the cameras are turned by 5 deg in pitch and back, each second", jumps},
      {"yaw-jumps", "the same in yaw", jumps},
      {"half-period", "the right camera is exposed half a period later", exposure},
      {"swapped", "left and right are exchanged", rig},
      {"twice", "both cameras are the left one", rig},
      {"wrong-rig", "the rig file of two other cameras", rig},
      {"wrong-stamps", "right images of the next pair", rig},
  };
  return all;
}

const Disturbance& disturbanceNamed(const std::string& name) {
  for (const Disturbance& disturbance : allDisturbances())
    if (disturbance.name == name) return disturbance;
  throw std::invalid_argument("there is no disturbance named " + name);
}

DisturbedSequence disturbed(const Sequence& sequence, const Disturbance& disturbance) {
  DisturbedSequence result{capture::openSource(sequence.folder), {}, sequence.truth};
  result.rig = pipeline::findRig(result.source, sequence.folder, {});
  const capture::ImageFolder images = capture::readImageFolder(sequence.folder);
  switch (disturbance.kind) {
    case DisturbanceKind::none:
      break;
    case DisturbanceKind::pairs: {
      const Indices kept = keptPairs(disturbance.name, images.left);
      const capture::ImageSequence left = chosen(images.left, kept);
      result.source.left = std::make_unique<capture::ImageSequenceSource>(left);
      result.source.right = std::make_unique<capture::ImageSequenceSource>(chosen(images.right, kept));
      result.source.pairs = left.images.size();
      result.truth = {chosen(sequence.truth.left_camera, kept), chosen(sequence.truth.body_twist, kept)};
      break;
    }
    case DisturbanceKind::picture:
      changePictures(result.source, pictureChange(disturbance.name));
      break;
    case DisturbanceKind::jumps:
      addJumps(disturbance.name, images.left.instants_ns.front(), result);
      break;
    case DisturbanceKind::exposure:
      result.source = openAlternate(sequence.folder, RightFrames::next, false);
      result.truth = alternate(sequence.truth);
      break;
    case DisturbanceKind::rig:
      applyRigFault(disturbance.name, images, result);
      break;
  }
  return result;
}

}  // namespace cartvo::benchmark
