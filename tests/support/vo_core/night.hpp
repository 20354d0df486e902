#pragma once

#include <opencv2/core.hpp>

namespace cartvo::test {

/// The image at night: a sixth of the light, and a camera's noise of two grey values.
inline cv::Mat atNight(const cv::Mat& image, cv::RNG& random) {
  constexpr double kLight = 0.16, kNoise = 2.0, kBlackLevel = 16.0;
  cv::Mat noise(image.size(), CV_16SC1), dark, night;
  random.fill(noise, cv::RNG::NORMAL, 0.0, kNoise);
  image.convertTo(dark, CV_16SC1, kLight, kBlackLevel);
  cv::Mat(dark + noise).convertTo(night, CV_8UC1);
  return night;
}

}  // namespace cartvo::test
