// Tests of the stereo match on textures shifted exactly by known disparities.
#include "vo_core/stereo/stereo_matcher.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/stereo/subpixel_fit.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 400, kHeight = 120;

cv::Mat leftView(const test::WaveTexture& texture) {
  return test::draw(kWidth, kHeight, texture);
}

cv::Mat rightView(const test::WaveTexture& texture, double disparity) {
  return test::draw(kWidth, kHeight, [&](double x, double y) { return texture(x + disparity, y); });
}

struct DisparityErrors {
  test::Statistics error;
  int attempted = 0;
};

DisparityErrors matchGrid(double disparity, int level) {
  const test::WaveTexture texture(11);
  const ImagePyramid left = buildPyramid(leftView(texture), level + 1);
  const ImagePyramid right = buildPyramid(rightView(texture, disparity), level + 1);
  DisparityErrors errors;
  for (int y = 20; y < kHeight - 20; y += 5) {
    for (int x = 110; x < kWidth - 20; x += 5) {
      ++errors.attempted;
      const auto match = matchStereo(left, right, {x + 0.3, y + 0.6}, StereoSettings{}, {}, level);
      if (match) errors.error.add(match->disparity - disparity);
    }
  }
  return errors;
}

TEST(StereoMatcher, FindsDisparitiesNearAndFarWithoutBias) {
  for (const double disparity : {0.6, 1.0, 1.25, 2.5, 5.1, 7.75, 12.3, 25.5, 40.9, 61.35, 80.0}) {
    const DisparityErrors errors = matchGrid(disparity, 0);
    EXPECT_GT(errors.error.count(), 0.8 * errors.attempted) << disparity;
    EXPECT_LT(std::abs(errors.error.mean()), 0.02) << disparity;
    EXPECT_LT(errors.error.stddev(), 0.06) << disparity;
  }
}

TEST(StereoMatcher, FindsDisparitiesAtHalfResolution) {
  for (const double disparity : {1.25, 5.1, 25.5, 61.35, 80.0}) {
    const DisparityErrors errors = matchGrid(disparity, 1);
    EXPECT_GT(errors.error.count(), 0.8 * errors.attempted) << disparity;
    EXPECT_LT(std::abs(errors.error.mean()), 0.04) << disparity;
    EXPECT_LT(errors.error.stddev(), 0.12) << disparity;
  }
}

TEST(StereoMatcher, RejectsAMissingLevel) {
  const test::WaveTexture texture(3);
  const ImagePyramid left = buildPyramid(leftView(texture), 2);
  const ImagePyramid right = buildPyramid(rightView(texture, 5.0), 1);
  EXPECT_FALSE(matchStereo(left, right, {200, 60}, StereoSettings{}, {}, 1));
}

TEST(StereoMatcher, FindsAMatchOneRowOff) {
  const test::WaveTexture texture(3);
  const ImagePyramid left = buildPyramid(leftView(texture), 1);
  const ImagePyramid right = buildPyramid(
      test::draw(kWidth, kHeight, [&](double x, double y) { return texture(x + 9.4, y - 1.0); }), 1);
  const auto match = matchStereo(left, right, {200, 60}, StereoSettings{});
  ASSERT_TRUE(match.has_value());
  EXPECT_EQ(match->right.y(), 61.0);
  EXPECT_NEAR(match->disparity, 9.4, 0.05);
}

TEST(StereoMatcher, RejectsRepetitiveTexture) {
  // A fence that repeats every 24 px, so that no disparity is better than the next.
  const auto fence = [](double x, double y) {
    return 128.0 + 60.0 * std::sin(2.0 * M_PI * x / 24.0) + 20.0 * std::sin(y / 3.0);
  };
  const ImagePyramid left = buildPyramid(test::draw(kWidth, kHeight, fence), 1);
  const ImagePyramid right =
      buildPyramid(test::draw(kWidth, kHeight, [&](double x, double y) { return fence(x + 30.0, y); }), 1);
  int matched = 0;
  for (int x = 150; x < 350; x += 4)
    matched += matchStereo(left, right, {x, 60.0}, StereoSettings{}).has_value() ? 1 : 0;
  EXPECT_EQ(matched, 0);
}

TEST(StereoMatcher, RejectsUnrelatedImages) {
  const ImagePyramid left = buildPyramid(leftView(test::WaveTexture(1)), 1);
  const ImagePyramid right = buildPyramid(rightView(test::WaveTexture(2), 0.0), 1);
  const ImagePyramid black = buildPyramid(cv::Mat::zeros(kHeight, kWidth, CV_8UC1), 1);
  int matched = 0;
  for (int x = 20; x < 380; x += 4) {
    matched += matchStereo(left, right, {x, 60.0}, StereoSettings{}).has_value() ? 1 : 0;
    EXPECT_FALSE(matchStereo(left, black, {x, 60.0}, StereoSettings{}).has_value());
    EXPECT_FALSE(matchStereo(black, left, {x, 60.0}, StereoSettings{}).has_value());
  }
  EXPECT_LE(matched, 5);  // of 90
}

TEST(StereoMatcher, StaysInsideTheImages) {
  const ImagePyramid left = buildPyramid(leftView(test::WaveTexture(1)), 1);
  for (const double x : {0.0, 0.5, 3.0, kWidth - 1.0})
    for (const double y : {0.0, 2.5, kHeight - 1.0})
      matchStereo(left, left, {x, y}, StereoSettings{});
  EXPECT_FALSE(matchStereo(left, left, {-1.0, 10.0}, StereoSettings{}).has_value());
}

TEST(SinusoidalPeak, FindsThePeakOfASinusoidExactly) {
  for (const double offset : {-0.49, -0.3, 0.0, 0.2, 0.45}) {
    const auto value = [&](double x) { return 0.97 * std::cos(0.7 * (x - offset)); };
    EXPECT_NEAR(sinusoidalOffset(value(-1), value(0), value(1)), offset, 1e-12);
    EXPECT_NEAR(sinusoidalHeight(value(-1), value(0), value(1)), 0.97, 1e-12);
  }
}

TEST(SinusoidalPeak, StaysAtTheMiddleOfAFlatTop) {
  EXPECT_EQ(sinusoidalOffset(0.9, 0.9, 0.9), 0.0);
  EXPECT_EQ(sinusoidalHeight(0.9, 0.9, 0.9), 0.9);
}

}  // namespace
}  // namespace cartvo::vo
