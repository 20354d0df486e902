// Tests of the distribution of new landmarks by the tracking success of earlier ones.
#include "vo_core/tracking/landmark_detector.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"

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

}  // namespace
}  // namespace cartvo::vo
