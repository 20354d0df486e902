// Tests of the distribution of new landmarks by the tracking success of earlier ones.
#include "vo_core/tracking/landmark_detector.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/tracking/adaptive_detector.hpp"
#include "vo_core/tracking/landmark.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 640, kHeight = 320, kFeatures = 300;

struct Counts {
  int fine = 0, coarse = 0;
};

class LandmarkDetectorTest : public testing::Test {
 protected:
  const std::vector<LandmarkCorner>& detect(const std::vector<Landmark>& alive = {}) {
    spacing_.reset(kWidth, kHeight, 8.0);
    for (const Landmark& landmark : alive)
      spacing_.insert(landmark.last().left);
    return detector_.detect(pyramid_, alive, spacing_);
  }

  /// Reports for each new corner of 40 pairs whether it `lasts`; counts the corners of the last pair.
  template <typename Lasts>
  Counts afterTrials(const Lasts& lasts) {
    Counts counts;
    for (int pair = 0; pair < 40; ++pair) {
      counts = {};
      for (const LandmarkCorner& corner : detect()) {
        ++(corner.level > 0 ? counts.coarse : counts.fine);
        detector_.recordOutcome(landmarkAt(corner), lasts(corner));
      }
    }
    return counts;
  }

  static Landmark landmarkAt(const LandmarkCorner& corner) {
    Landmark landmark;
    landmark.level = corner.level;
    landmark.observations.push_back({.frame = 0, .left = corner.pixel});
    return landmark;
  }

  ImagePyramid pyramid_ = buildPyramid(test::draw(kWidth, kHeight, test::WaveTexture(2)), 2);
  SpacingGrid spacing_;
  DetectionSettings settings_ = [] {
    DetectionSettings settings;
    settings.minimum_threshold = 2;
    return settings;
  }();
  LandmarkDetector detector_{settings_, kFeatures, cv::Size(kWidth, kHeight)};
};

TEST_F(LandmarkDetectorTest, UsesFineCornersAsLongAsTheyLast) {
  const Counts counts = afterTrials([](const LandmarkCorner&) { return true; });
  EXPECT_GT(counts.fine, 0.95 * kFeatures);
  EXPECT_LT(counts.coarse, 0.02 * kFeatures);
}

TEST_F(LandmarkDetectorTest, UsesCoarseCornersWhereOnlyTheyLast) {
  const auto dark = [](const LandmarkCorner& corner) { return corner.pixel.x() < 0.5 * kWidth; };
  const Counts counts =
      afterTrials([&](const LandmarkCorner& corner) { return corner.level > 0 || !dark(corner); });
  EXPECT_GT(counts.coarse, 0.15 * kFeatures);  // less than half: a coarse corner has less utility
  for (const LandmarkCorner& corner : detect()) {
    if (corner.level == 0) continue;
    EXPECT_LT(corner.pixel.x(), 0.5 * kWidth + 40);
  }
}

TEST_F(LandmarkDetectorTest, ReturnsToFineCornersWhenTheyLastAgain) {
  afterTrials([](const LandmarkCorner& corner) { return corner.level > 0; });
  for (int times = 0; times < 10; ++times)
    afterTrials([](const LandmarkCorner&) { return true; });
  const Counts counts = afterTrials([](const LandmarkCorner&) { return true; });
  EXPECT_GT(counts.fine, 0.9 * kFeatures);
}

TEST_F(LandmarkDetectorTest, FillsUpToTheTargetAndKeepsTheDistance) {
  std::vector<Landmark> alive;
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(100, 100), Eigen::Vector2d(300, 200)})
    alive.push_back(landmarkAt({pixel, 0}));
  afterTrials(
      [](const LandmarkCorner& corner) { return corner.level > 0; });  // so that both levels contribute
  const auto corners = detect(alive);
  EXPECT_EQ(corners.size(), kFeatures - alive.size());
  std::vector<Eigen::Vector2d> places{alive[0].last().left, alive[1].last().left};
  for (const LandmarkCorner& corner : corners)
    places.push_back(corner.pixel);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE((places[i] - places[j]).norm(), 8.0);
}

TEST_F(LandmarkDetectorTest, UsesFineCornersInAnImageTooSmallToBeHalved) {
  pyramid_.grey.resize(1);
  const Counts counts = afterTrials([](const LandmarkCorner&) { return false; });
  EXPECT_EQ(counts.coarse, 0);
  EXPECT_GT(counts.fine, 0);
}

TEST(PatchNoise, GrowsWithAlignmentVarianceAndLevel) {
  const Eigen::Vector2d steep = relativeNoise({0.0, 0.0}, 0, {});
  const Eigen::Vector2d edge = relativeNoise({0.04 * 0.04, 0.4 * 0.4}, 0, {});
  EXPECT_GT(steep.minCoeff(), 0.5);  // no patch has an exact position
  EXPECT_LT(edge.x(), 1.2 * steep.x());
  EXPECT_GT(edge.y(), 4.0 * steep.y());
  EXPECT_EQ(relativeNoise({0.0, 0.0}, 1, {}), 2.0 * steep);
}

TEST(PatchNoise, IsInflatedForInterCodedPicturesMostForSteepPatches) {
  std::vector<Landmark> landmarks(2);
  landmarks[0].observations.push_back({.relative_noise = relativeNoise({0.0, 0.0}, 0, {})});
  landmarks[1].observations.push_back({.relative_noise = relativeNoise({0.25, 0.25}, 0, {})});
  inflateCodecNoise(landmarks, {});
  const double steep = landmarks[0].last().relative_noise.x() / relativeNoise({0.0, 0.0}, 0, {}).x();
  const double soft = landmarks[1].last().relative_noise.x() / relativeNoise({0.25, 0.25}, 0, {}).x();
  EXPECT_GT(steep, 1.5);
  EXPECT_GT(soft, 1.0);
  EXPECT_LT(soft, 1.05);
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
