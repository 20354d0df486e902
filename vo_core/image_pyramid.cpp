// Gaussian and difference-of-Gaussian pyramids (P. Burt, E. Adelson, "The Laplacian pyramid as a compact
// image code", 1983), one of each for all stages that need them.
#include "vo_core/image_pyramid.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace cartvo {
namespace {

constexpr double kDogSigma = 1.0;  // px, of the wider Gaussian against the level itself
constexpr double kDogGain = 3.0;   // so that weak texture uses the range of a byte; strong texture saturates

cv::Mat differenceOfGaussians(const cv::Mat& level) {
  cv::Mat blurred;
  cv::GaussianBlur(level, blurred, cv::Size(5, 5), kDogSigma);
  cv::Mat difference;
  cv::addWeighted(level, kDogGain, blurred, -kDogGain, 128.0, difference);
  return difference;
}

}  // namespace

PyramidLevel::PyramidLevel(const cv::Mat& image) {
  cv::copyMakeBorder(image, padded_, kBorder, kBorder, kBorder, kBorder, cv::BORDER_REFLECT_101);
}

ImagePyramid buildPyramid(const cv::Mat& image, int grey_levels) {
  ImagePyramid pyramid;
  cv::Mat level = image;
  for (int index = 0; index < std::max(grey_levels, kDogLevels); ++index) {
    if (index > 0) {
      if (std::min(level.cols, level.rows) < 8) break;
      cv::Mat half;
      cv::pyrDown(level, half);
      level = half;
    }
    if (index < grey_levels) pyramid.grey.emplace_back(level);
    if (index < kDogLevels) pyramid.dog.emplace_back(differenceOfGaussians(level));
  }
  return pyramid;
}

}  // namespace cartvo
