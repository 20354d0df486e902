// Detection of images that repeat while the cart moves.
#include "vo_core/integrity/repeated_image_detector.hpp"

#include <algorithm>
#include <cstring>

#include "vo_core/geometry/plausible_motion.hpp"

namespace cartvo::vo {
namespace {

constexpr int kComparedRows = 32;  // evenly spread over the image; motion changes some of them

}  // namespace

const std::uint8_t* RepeatedImageDetector::Camera::unmasked(const cv::Mat& image, int y) {
  const std::uint8_t* const pixels = image.ptr(y);
  if (mask.empty()) return pixels;
  const std::uint8_t* const used = mask.ptr(y);
  row.resize(static_cast<std::size_t>(image.cols));
  for (std::size_t x = 0; x < row.size(); ++x)
    row[x] = used[x] == 0 ? 0 : pixels[x];
  return row.data();
}

bool RepeatedImageDetector::Camera::repeats(const cv::Mat& image) {
  const auto width = static_cast<std::size_t>(image.cols);
  const int count = std::min(kComparedRows, image.rows);
  const bool comparable = rows.size() == count * width;
  rows.resize(count * width);
  bool same = comparable;
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* const next = unmasked(image, i * image.rows / count);
    std::uint8_t* const previous = rows.data() + i * width;
    same = same && std::memcmp(next, previous, width) == 0;
    if (!same) std::memcpy(previous, next, width);
  }
  return same;
}

ImageRepeats RepeatedImageDetector::update(const StereoImages& images, const OdometryEstimate& last) {
  // The speed is unknown after an invalid estimate.
  const double time_step = 1e-9 * static_cast<double>(images.left_exposure_ns - last.exposure_ns);
  const bool can_stop =
      !last.valid || canStop(vectorFromMotion(last.T_previous_current) / last.time_step, time_step);
  ImageRepeats repeats;
  repeats.left = cameras_[0].repeats(images.left);
  repeats.right = cameras_[1].repeats(images.right);
  cameras_[0].frozen = repeats.left && (cameras_[0].frozen || !can_stop);
  cameras_[1].frozen = repeats.right && (cameras_[1].frozen || !can_stop);
  repeats.while_moving = cameras_[0].frozen || cameras_[1].frozen;
  return repeats;
}

}  // namespace cartvo::vo
