// Tests of the adaptive FAST thresholds and of the minimum distance between features.
#include "vo_core/tracking/adaptive_detector.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

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
    detector.detect({image}, {}, spacing);
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
    EXPECT_TRUE(detector.detect({plain}, {}, spacing).empty());
    EXPECT_LT(detector.threshold(0), before);
    before = detector.threshold(0);
  }
  EXPECT_EQ(detector.threshold(0), settings.minimum_threshold);
}

TEST(AdaptiveDetector, FillsUpToTheTargetAndKeepsTheDistance) {
  const cv::Mat image = test::draw(640, 320, test::WaveTexture(2));
  DetectionSettings settings;
  AdaptiveDetector detector(settings, 300, image.size());
  SpacingGrid spacing(640, 320, 8.0);
  std::vector<Eigen::Vector2d> alive{{100, 100}, {120, 100}, {300, 200}};
  for (const auto& point : alive)
    ASSERT_TRUE(spacing.insert(point));
  const auto corners = detector.detect({image}, alive, spacing);
  EXPECT_EQ(corners.size(), 297U);
  for (const Corner& corner : corners)
    alive.emplace_back(corner.x, corner.y);
  for (std::size_t i = 0; i < alive.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE((alive[i] - alive[j]).norm(), 8.0);
}

TEST(SpacingGrid, RejectsOnlyPointsThatAreTooClose) {
  test::Noise noise(4);
  SpacingGrid spacing(50, 40, 20.0);
  for (const double distance : {8.0, 5.3}) {
    spacing.reset(90, 60, distance);
    std::vector<Eigen::Vector2d> kept;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector2d point(90.0 * noise.uniform(), 60.0 * noise.uniform());
      const bool free = std::none_of(kept.begin(), kept.end(), [&](const Eigen::Vector2d& other) {
        return (other - point).norm() < distance;
      });
      ASSERT_EQ(spacing.insert(point), free) << point.transpose();
      if (free) kept.push_back(point);
    }
    EXPECT_GT(kept.size(), 30U);
  }
}

TEST(SpacingGrid, RejectsPointsOutsideTheImage) {
  SpacingGrid spacing(100, 50, 7.0);
  EXPECT_FALSE(spacing.insert({-1.0, 10.0}));
  EXPECT_FALSE(spacing.insert({10.0, 200.0}));
  EXPECT_TRUE(spacing.insert({99.9, 49.9}));
  EXPECT_FALSE(spacing.insert({95.0, 47.0}));
}

}  // namespace
}  // namespace cartvo::vo
