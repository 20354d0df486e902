// Tests of tracking on exactly warped textures, so that every error is the tracker's own.
#include "vo_core/thesis/klt.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 320, kHeight = 240;

struct TrackingErrors {
  test::Statistics x, y;
  int tracked = 0, attempted = 0;
};

/// Tracks a grid of points of a texture. `backward`: pixel after to pixel before; `forward`: the inverse.
template <typename Forward, typename Backward, typename Brightness>
TrackingErrors trackGrid(const Forward& forward, const Backward& backward, const Brightness& brightness) {
  const test::WaveTexture texture(5);
  const TrackingSettings settings;
  const ImagePyramid before = buildPyramid(test::draw(kWidth, kHeight, texture), settings.levels);
  const ImagePyramid after = buildPyramid(test::draw(kWidth, kHeight,
                                                     [&](double x, double y) {
                                                       const Eigen::Vector2d source = backward({x, y});
                                                       return brightness(texture(source.x(), source.y()));
                                                     }),
                                          settings.levels);
  TrackingErrors errors;
  for (int y = 50; y < kHeight - 50; y += 7) {
    for (int x = 50; x < kWidth - 50; x += 7) {
      const Eigen::Vector2d from(x + 0.1 * (x % 10), y + 0.1 * (y % 10));
      const KltResult result = trackPatch(before, after, from, from, settings.levels, settings);
      ++errors.attempted;
      if (!result.found) continue;
      ++errors.tracked;
      const Eigen::Vector2d error = result.position - forward(from);
      errors.x.add(error.x());
      errors.y.add(error.y());
    }
  }
  return errors;
}

double unchanged(double grey) {
  return grey;
}

TEST(Klt, TracksAnExactShiftWithoutBias) {
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.25, -0.4), Eigen::Vector2d(3.3, 7.7), Eigen::Vector2d(-14.6, 5.5)}) {
    const auto errors =
        trackGrid([&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p + shift); },
                  [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p - shift); }, unchanged);
    EXPECT_GT(errors.tracked, 0.97 * errors.attempted) << shift.transpose();
    // A bias of 0.3 % of the shift, as OpenCV's has, would be 0.044 px at 14.6 px.
    EXPECT_LT(std::abs(errors.x.mean()), 0.004) << shift.transpose();
    EXPECT_LT(std::abs(errors.y.mean()), 0.004) << shift.transpose();
    EXPECT_LT(errors.x.stddev(), 0.04) << shift.transpose();
    EXPECT_LT(errors.y.stddev(), 0.04) << shift.transpose();
  }
}

TEST(Klt, TracksAGrowingPatch) {
  const Eigen::Vector2d centre(kWidth / 2.0, kHeight / 2.0);
  const double zoom = 1.12;
  const auto errors = trackGrid(
      [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(centre + zoom * (p - centre)); },
      [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(centre + (p - centre) / zoom); }, unchanged);
  EXPECT_GT(errors.tracked, 0.9 * errors.attempted);
  EXPECT_LT(std::abs(errors.x.mean()), 0.02);
  EXPECT_LT(std::abs(errors.y.mean()), 0.02);
  EXPECT_LT(errors.x.stddev(), 0.15);
  EXPECT_LT(errors.y.stddev(), 0.15);
}

TEST(Klt, IsInvariantToBrightness) {
  const Eigen::Vector2d shift(2.6, -1.3);
  const auto errors = trackGrid([&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p + shift); },
                                [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p - shift); },
                                [](double grey) { return grey + 30.0; });
  EXPECT_GT(errors.tracked, 0.95 * errors.attempted);
  EXPECT_LT(std::abs(errors.x.mean()), 0.01);
  EXPECT_LT(errors.x.stddev(), 0.05);
}

TEST(Klt, FailsWithoutTexture) {
  const cv::Mat grey(kHeight, kWidth, CV_8UC1, cv::Scalar(100));
  const ImagePyramid pyramid = buildPyramid(grey, 4);
  EXPECT_FALSE(trackPatch(pyramid, pyramid, {100, 100}, {100, 100}, 4, TrackingSettings{}).found);
}

TEST(Klt, FailsOnUnrelatedImages) {
  const ImagePyramid before = buildPyramid(test::draw(kWidth, kHeight, test::WaveTexture(1)), 4);
  const ImagePyramid after = buildPyramid(test::draw(kWidth, kHeight, test::WaveTexture(2)), 4);
  int found = 0;
  for (int x = 40; x < 280; x += 5)
    found += trackPatch(before, after, {x, 120.0}, {x, 120.0}, 4, TrackingSettings{}).found ? 1 : 0;
  EXPECT_LE(found, 8);  // of 48
}

TEST(Klt, RejectsGuessesOutsideTheImage) {
  const ImagePyramid pyramid = buildPyramid(test::draw(kWidth, kHeight, test::WaveTexture(1)), 4);
  for (const double far : {-1e7, -40.0, 1000.0, 1e7})
    EXPECT_FALSE(trackPatch(pyramid, pyramid, {100, 100}, {far, far}, 4, TrackingSettings{}).found);
}

}  // namespace
}  // namespace cartvo::vo
