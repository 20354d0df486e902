// FAST, its score, its suppression and the thresholds that adapt.
#include "vo_core/adaptive_detector.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "vo_core/synthetic_texture.hpp"

namespace cartvo {
namespace {

TEST(FastCorners, ScoreIsTheSumOfAbsoluteDifferencesOnTheCircle) {
  cv::Mat image(20, 20, CV_8UC1, cv::Scalar(50));
  image.at<unsigned char>(10, 10) = 200;  // a bright dot: all sixteen pixels of its circle are darker by 150
  EXPECT_EQ(fastScore(image, 10, 10, 40), 16 * 150);
  EXPECT_EQ(fastScore(image, 10, 10, 150), 0);
  EXPECT_EQ(fastScore(image, 5, 5, 40), 0);
}

TEST(FastCorners, NeedsNineContiguousPixels) {
  cv::Mat half(20, 20, CV_8UC1, cv::Scalar(50));
  half(cv::Rect(10, 0, 10, 20))
      .setTo(200);  // on a straight edge seven to nine pixels differ, not an arc of nine
  EXPECT_EQ(fastScore(half, 10, 10, 40), 0);
  cv::Mat corner(20, 20, CV_8UC1, cv::Scalar(50));
  corner(cv::Rect(10, 10, 10, 10)).setTo(200);
  EXPECT_GT(fastScore(corner, 10, 10, 40), 0);
}

TEST(FastCorners, AreFoundInTheirWindowAndScored) {
  test::Noise noise(3);
  cv::Mat image(60, 80, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(noise.uniform() * 255.0);
  const cv::Rect window(20, 0, 30, 40);
  cv::Mat scores(image.size(), CV_16UC1, cv::Scalar(0));
  const auto corners = findCorners(image, window, 50, scores);
  int expected = 0;
  for (int y = kFastRadius; y < window.br().y; ++y)  // the window touches the upper edge of the image
    for (int x = window.x; x < window.br().x; ++x) {
      const std::uint16_t score = fastScore(image, x, y, 50);
      EXPECT_EQ(scores.at<std::uint16_t>(y, x), score);
      if (score > 0) ++expected;
    }
  EXPECT_GT(expected, 10);
  EXPECT_EQ(static_cast<int>(corners.size()), expected);
}

TEST(FastCorners, SuppressionKeepsTheStrongestOfNeighbours) {
  // Of the last two, which are equal, the first stays.
  const std::vector<Corner> corners = {{8, 8, 100}, {9, 8, 200}, {9, 9, 150}, {5, 14, 70}, {6, 14, 70}};
  cv::Mat scores(20, 20, CV_16UC1, cv::Scalar(0));
  for (const Corner& corner : corners)
    scores.at<std::uint16_t>(corner.y, corner.x) = corner.score;
  const auto maxima = localMaxima(scores, corners);
  ASSERT_EQ(maxima.size(), 2U);
  EXPECT_EQ(maxima[0].x, 9);
  EXPECT_EQ(maxima[0].y, 8);
  EXPECT_EQ(maxima[0].score, 200);
  EXPECT_EQ(maxima[1].x, 5);
}

TEST(AdaptiveDetector, DarkAndBrightHalvesConvergeToTheirTargets) {
  test::Noise noise(7);
  cv::Mat texture(320, 640, CV_32FC1);
  for (float& grey : cv::Mat_<float>(texture))
    grey = static_cast<float>(noise.gaussian());
  cv::GaussianBlur(texture, texture, cv::Size(5, 5), 1.0);
  const cv::Mat image = test::draw(640, 320, [&](int x, int y) {
    const float contrast = texture.at<float>(y, x);
    return x < 320 ? 60.0F + 40.0F * contrast : 128.0F + 90.0F * contrast;
  });
  DetectionSettings settings;
  settings.window_columns = 8;
  settings.window_rows = 4;
  settings.minimum_threshold = 1;
  AdaptiveDetector detector(settings, 400, image.size());
  for (int i = 0; i < 30; ++i) {
    SpacingGrid spacing(640, 320, 5.0);
    detector.detect(image, {}, spacing);
  }
  double dark = 0.0;
  double bright = 0.0;
  test::Statistics dark_count;
  test::Statistics bright_count;
  for (int i = 0; i < detector.windowCount(); ++i) {
    const bool is_dark = detector.window(i).x < 320;
    (is_dark ? dark : bright) += detector.threshold(i);
    (is_dark ? dark_count : bright_count).add(detector.cornerCount(i));
    // A threshold is a whole grey value: in the dark one step changes the count by a third.
    EXPECT_NEAR(detector.cornerCount(i), detector.cornerTarget(), 0.6 * detector.cornerTarget())
        << "window " << i;
  }
  EXPECT_NEAR(dark_count.mean(), detector.cornerTarget(), 0.2 * detector.cornerTarget());
  EXPECT_NEAR(bright_count.mean(), detector.cornerTarget(), 0.2 * detector.cornerTarget());
  EXPECT_LT(1.7 * dark, bright);
}

TEST(AdaptiveDetector, TooFewCornersLowerTheThresholdToItsMinimum) {
  const cv::Mat plain(240, 320, CV_8UC1, cv::Scalar(90));
  const DetectionSettings settings;
  AdaptiveDetector detector(settings, 400, plain.size());
  SpacingGrid spacing(320, 240, 5.0);
  int before = detector.threshold(0);
  for (int i = 0; i < 10 && before > settings.minimum_threshold; ++i) {
    EXPECT_TRUE(detector.detect(plain, {}, spacing).empty());
    EXPECT_LT(detector.threshold(0), before);
    before = detector.threshold(0);
  }
  EXPECT_EQ(detector.threshold(0), settings.minimum_threshold);
}

TEST(AdaptiveDetector, FillsUpToTheAimedNumberAndKeepsTheDistance) {
  const cv::Mat image = test::draw(640, 320, test::WaveTexture(2));
  DetectionSettings settings;
  settings.initial_threshold = 8;
  AdaptiveDetector detector(settings, 300, image.size());
  SpacingGrid spacing(640, 320, 8.0);
  std::vector<Eigen::Vector2d> alive{{100, 100}, {120, 100}, {300, 200}};
  for (const auto& point : alive)
    ASSERT_TRUE(spacing.insert(point));
  const auto corners = detector.detect(image, alive, spacing);
  EXPECT_EQ(corners.size(), 297U);
  for (const Corner& corner : corners)
    alive.emplace_back(corner.x, corner.y);
  for (std::size_t i = 0; i < alive.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE((alive[i] - alive[j]).norm(), 8.0);
}

TEST(SpacingGrid, RefusesPointsOutsideTheImage) {
  SpacingGrid spacing(100, 50, 7.0);
  EXPECT_FALSE(spacing.insert({-1.0, 10.0}));
  EXPECT_FALSE(spacing.insert({10.0, 200.0}));
  EXPECT_TRUE(spacing.insert({99.9, 49.9}));
  EXPECT_FALSE(spacing.insert({95.0, 47.0}));
}

}  // namespace
}  // namespace cartvo
