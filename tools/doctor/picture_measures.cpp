// Light and sharpness of a picture.
#include "tools/doctor/picture_measures.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace cartvo::doctor {
namespace {

constexpr double kBlurred = 0.25;   // ratio of squared gradients of a very blurred picture to its half's
constexpr double kMinSquare = 2.0;  // square of grey values per px, mean; less is noise

/// Mean squared gradient, (grey values per px)^2.
double meanSquaredGradient(const cv::Mat& picture, const cv::Mat& used) {
  cv::Mat x, y;
  cv::Sobel(picture, x, CV_32F, 1, 0, 1, 0.5);
  cv::Sobel(picture, y, CV_32F, 0, 1, 1, 0.5);
  const cv::Mat squares = x.mul(x) + y.mul(y);
  return cv::mean(squares, used)[0];
}

}  // namespace

std::optional<double> sharpnessOf(const cv::Mat& picture, const cv::Mat& used) {
  cv::Mat half, half_used;
  cv::pyrDown(picture, half);
  if (!used.empty()) cv::resize(used, half_used, half.size(), 0.0, 0.0, cv::INTER_NEAREST);
  const double coarse = meanSquaredGradient(half, half_used);
  if (coarse < kMinSquare) return std::nullopt;
  return meanSquaredGradient(picture, used) / coarse;
}

double excessSharpness(double sharpness) {
  constexpr double kLeast = 0.01;
  return std::max(sharpness - kBlurred, kLeast);
}

PictureMeasures measurePicture(const cv::Mat& picture, const cv::Mat& used) {
  return {pipeline::measureLight(picture, used), sharpnessOf(picture, used)};
}

}  // namespace cartvo::doctor
