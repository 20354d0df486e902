// Pictures that come again while the cart moves.
#include "vo_core/repeated_pictures.hpp"

#include <algorithm>
#include <cstring>

#include "vo_core/plausible_motion.hpp"

namespace cartvo {
namespace {

constexpr int kRows = 32;  // of a picture, evenly spread: what moves shows in some of them

}  // namespace

bool RepeatedPictures::Picture::next(const cv::Mat& image) {
  const auto width = static_cast<std::size_t>(image.cols);
  const int count = std::min(kRows, image.rows);
  const bool comparable = rows.size() == count * width;
  rows.resize(count * width);
  bool same = comparable;
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* const row = image.ptr(i * image.rows / count);
    std::uint8_t* const before = rows.data() + i * width;
    same = same && std::memcmp(row, before, width) == 0;
    if (!same) std::memcpy(before, row, width);
  }
  return same;
}

PictureRepeats RepeatedPictures::take(const StereoImages& images, const OdometryEstimate& last) {
  // After a pair that told no motion nobody knows.
  const double time_step = 1e-9 * static_cast<double>(images.left_exposure_ns - last.exposure_ns);
  const bool can_stop =
      !last.valid || canStop(vectorFromMotion(last.T_previous_current) / last.time_step, time_step);
  PictureRepeats repeats;
  repeats.left = pictures_[0].next(images.left);
  repeats.right = pictures_[1].next(images.right);
  pictures_[0].hangs = repeats.left && (pictures_[0].hangs || !can_stop);
  pictures_[1].hangs = repeats.right && (pictures_[1].hangs || !can_stop);
  repeats.of_moving_cart = pictures_[0].hangs || pictures_[1].hangs;
  return repeats;
}

}  // namespace cartvo
