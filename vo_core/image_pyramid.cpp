// Gaussian and difference-of-Gaussian pyramids (P. Burt, E. Adelson, "The Laplacian pyramid as a compact
// image code", 1983), one of each for all stages that need them.
#include "vo_core/image_pyramid.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace cartvo {
namespace {

constexpr double kDogSigma = 1.0;  // px, of the wider Gaussian against the level itself
constexpr int kLeastToHalve = 8;   // px
constexpr double kDogGain = 3.0;   // so that weak texture uses the range of a byte; strong texture saturates

void differenceOfGaussians(const cv::Mat& level, cv::Mat& scratch, PyramidLevel& out) {
  cv::GaussianBlur(level, scratch, cv::Size(5, 5), kDogSigma);
  cv::addWeighted(level, kDogGain, scratch, -kDogGain, 128.0, out.image());
  out.writeBorder();
}

ImagePyramid emptyPyramid(const cv::Size& size, int grey_levels) {
  ImagePyramid pyramid;
  cv::Size level = size;
  for (int index = 0; index < std::max(grey_levels, kFinestDog + kDogLevels); ++index) {
    if (index > 0) {
      if (std::min(level.width, level.height) < kLeastToHalve) break;
      level = cv::Size((level.width + 1) / 2, (level.height + 1) / 2);
    }
    if (index < grey_levels) pyramid.grey.emplace_back(level);
    if (index >= kFinestDog && index < kFinestDog + kDogLevels) pyramid.dog.emplace_back(level);
  }
  return pyramid;
}

/// Levels that have no grey of their own are halved in `scratch`.
void fill(const cv::Mat& image, ImagePyramid& pyramid, cv::Mat& scratch) {
  cv::Mat level = image;
  const std::size_t levels = std::max(pyramid.grey.size(), kFinestDog + pyramid.dog.size());
  for (std::size_t index = 0; index < levels; ++index) {
    const bool grey = index < pyramid.grey.size();
    if (index == 0) {
      level.copyTo(pyramid.grey[0].image());
    } else {
      cv::Mat half = grey ? pyramid.grey[index].image() : cv::Mat();
      cv::pyrDown(level, half);
      level = half;
    }
    if (grey) {
      pyramid.grey[index].writeBorder();
      level = pyramid.grey[index].image();
    }
    if (index >= kFinestDog && index - kFinestDog < pyramid.dog.size())
      differenceOfGaussians(level, scratch, pyramid.dog[index - kFinestDog]);
  }
}

bool inUse(const ImagePyramid& pyramid) {
  const auto shared = [](const PyramidLevel& level) { return level.shared(); };
  return std::any_of(pyramid.grey.begin(), pyramid.grey.end(), shared) ||
         std::any_of(pyramid.dog.begin(), pyramid.dog.end(), shared);
}

}  // namespace

PyramidLevel::PyramidLevel(const cv::Size& size)
    : padded_(size.height + 2 * kBorder, size.width + 2 * kBorder, CV_8UC1) {}

void PyramidLevel::writeBorder() {
  cv::copyMakeBorder(image(), padded_, kBorder, kBorder, kBorder, kBorder,
                     cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
}

ImagePyramid PyramidPool::build(const cv::Mat& image) {
  auto free = std::find_if_not(pyramids_.begin(), pyramids_.end(), inUse);
  if (free == pyramids_.end()) free = pyramids_.insert(free, emptyPyramid(image.size(), grey_levels_));
  fill(image, *free, scratch_);
  return *free;
}

ImagePyramid buildPyramid(const cv::Mat& image, int grey_levels) {
  return PyramidPool(grey_levels).build(image);
}

}  // namespace cartvo
