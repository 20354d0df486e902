// Bands of lamps are taken out of pictures; pictures without bands stay as they are.

#include "pipeline/lamp_bands.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace cartvo::pipeline {
namespace {

constexpr int kPictures = 16;

/// A scene whose brightness differs from row to row, at rest.
cv::Mat scene() {
  cv::Mat picture(210, 320, CV_8UC1);
  cv::RNG random(5);
  random.fill(picture, cv::RNG::UNIFORM, 60, 120);
  for (int y = 0; y < picture.rows; ++y)
    picture.row(y) += y < 80 ? 60 : y / 10;
  return picture;
}

cv::Mat withGains(const std::function<double(int)>& gain) {
  cv::Mat picture = scene();
  for (int y = 0; y < picture.rows; ++y)
    picture.row(y).convertTo(picture.row(y), CV_8U, gain(y));
  return picture;
}

/// Mean distance of the picture's rows from those of the scene, as a share of the brightness.
double rowError(const cv::Mat& picture) {
  cv::Mat rows, true_rows;
  cv::reduce(picture, rows, 1, cv::REDUCE_AVG, CV_32F);
  cv::reduce(scene(), true_rows, 1, cv::REDUCE_AVG, CV_32F);
  const cv::Mat apart = cv::abs(rows / true_rows - 1.0);
  return cv::mean(apart)[0];
}

TEST(LampBands, TakesOutBandsThatRun) {
  LampBands bands;
  double before = 0.0, after = 0.0;
  for (int i = 0; i < kPictures; ++i) {
    const cv::Mat picture = withGains([i](int y) {
      return 0.85 + 0.15 * std::sin(2.0 * std::numbers::pi * (3.3 * y / 210.0 + 5.556 * i));
    });
    before = rowError(picture / 0.85), after = rowError(bands.without(picture) / 0.85);
  }
  EXPECT_GT(before, 0.08);
  EXPECT_LT(after, 0.25 * before);
}

TEST(LampBands, LeavesOtherPicturesAlone) {
  const std::function<double(int, int)> gains[] = {
      [](int, int) { return 1.0; },
      [](int i, int) { return i % 2 == 0 ? 0.8 : 1.0; },                    // the exposure changes
      [](int i, int y) { return y > 100 && y < 130 + 3 * i ? 0.7 : 1.0; },  // something dark comes near
      [](int, int y) { return 0.85 + 0.15 * std::sin(0.1 * y); }};          // bands that stand
  for (const auto& gain : gains) {
    LampBands bands;
    for (int i = 0; i < kPictures; ++i) {
      const cv::Mat picture = withGains([&](int y) { return gain(i, y); });
      EXPECT_EQ(bands.without(picture).data, picture.data);
    }
  }
}

}  // namespace
}  // namespace cartvo::pipeline
