// Light and texture of rendered and made-up pictures.
#include "pipeline/picture_light.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vo_core/odometry_reason.hpp"

namespace cartvo::pipeline {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Squares of 16 px of random grey values around a mean, with the noise of a sensor.
cv::Mat scene(double mean, double contrast) {
  cv::Mat squares(kHeight / 16, kWidth / 16, CV_32F), picture, noise(kHeight, kWidth, CV_32F);
  cv::RNG random(7);
  random.fill(squares, cv::RNG::UNIFORM, mean - contrast, mean + contrast);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::resize(squares, picture, noise.size(), 0.0, 0.0, cv::INTER_NEAREST);
  picture += noise;
  picture.convertTo(picture, CV_8U);
  return picture;
}

LightFault faultOf(const cv::Mat& picture, const cv::Mat& used = {}) {
  return lightFault(measureLight(picture, used));
}

TEST(PictureLight, FindsNoFaultByDay) {
  EXPECT_EQ(faultOf(scene(120.0, 60.0)), LightFault::none);
}

TEST(PictureLight, IsDarkAtDuskAndBehindABlackCover) {
  EXPECT_EQ(faultOf(0.07 * scene(120.0, 60.0)), LightFault::dark);
  EXPECT_EQ(faultOf(scene(16.0, 0.0)), LightFault::dark);
}

TEST(PictureLight, IsBlankBehindAFingerOrFogWhateverTheNoise) {
  cv::Mat shaded = scene(110.0, 0.0);
  for (int column = 0; column < kWidth; ++column)
    shaded.col(column) += column / 4;  // the shade of a finger is smooth
  EXPECT_EQ(faultOf(shaded), LightFault::blank);
  EXPECT_TRUE(lacksTexture(measureLight(shaded, {})));
}

TEST(PictureLight, IsTooBrightInGlare) {
  EXPECT_EQ(faultOf(2.0 * scene(120.0, 60.0)), LightFault::bright);
}

TEST(PictureLight, IgnoresWhatTheMaskCovers) {
  cv::Mat picture = scene(120.0, 0.0), used = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
  const cv::Rect bonnet(0, kHeight / 2, kWidth, kHeight / 2);
  scene(120.0, 60.0)(bonnet).copyTo(picture(bonnet));
  used(bonnet).setTo(0);
  EXPECT_EQ(faultOf(picture), LightFault::none);
  EXPECT_EQ(faultOf(picture, used), LightFault::blank);
}

TEST(PictureLight, ExplainsOnlyReasonsThatPicturesGive) {
  const auto bits = [](vo::OdometryReason reason) { return static_cast<std::uint32_t>(reason); };
  const PictureLight night{20.0, 0.3, 0.01, 0.1}, covered{8.0, 0.9, 0.0, 0.0};
  for (const vo::OdometryReason reason :
       {vo::OdometryReason::too_few_features, vo::OdometryReason::too_few_matches, vo::OdometryReason::bound})
    EXPECT_TRUE(mayExplain(night, bits(reason))) << bits(reason);
  for (const vo::OdometryReason reason :
       {vo::OdometryReason::offset_uncertain, vo::OdometryReason::time_step, vo::OdometryReason::first_pair})
    EXPECT_FALSE(mayExplain(covered, bits(reason))) << bits(reason);
  // Lamps show enough to compare left and right.
  EXPECT_FALSE(mayExplain(night, bits(vo::OdometryReason::wrong_stereo_geometry)));
  EXPECT_TRUE(mayExplain(covered, bits(vo::OdometryReason::wrong_stereo_geometry)));
  EXPECT_FALSE(mayExplain({}, bits(vo::OdometryReason::too_few_matches)));
}

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
