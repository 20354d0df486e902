// Tests of the affine alignment on exactly warped textures, so that every error is the alignment's own.
#include "vo_core/image/affine_alignment.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 240, kHeight = 180;

/// Change of the image: x after = centre + warp (x before - centre) + shift.
struct Change {
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double gain = 1.0;
  double brightness = 0.0;

  static Eigen::Vector2d centre() { return {0.5 * kWidth, 0.5 * kHeight}; }
  Eigen::Vector2d after(const Eigen::Vector2d& before) const {
    return centre() + warp * (before - centre()) + shift;
  }
  Eigen::Vector2d before(const Eigen::Vector2d& after) const {
    return centre() + warp.inverse() * (after - centre() - shift);
  }
};

struct AlignmentErrors {
  test::Statistics x, y, warp;
  int attempted = 0, aligned = 0;
};

/// Aligns a grid of points, from a start that is a little off and has no warp.
AlignmentErrors alignGrid(const Change& change) {
  const test::WaveTexture texture(23);
  const auto changed = [&](double x, double y) {
    const Eigen::Vector2d source = change.before({x, y});
    return change.gain * texture(source.x(), source.y()) + change.brightness;
  };
  const ImagePyramid before = buildPyramid(test::draw(kWidth, kHeight, texture), 1);
  const ImagePyramid after = buildPyramid(test::draw(kWidth, kHeight, changed), 1);
  const TrackingSettings settings;
  AlignmentErrors errors;
  for (int y = 40; y < kHeight - 40; y += 7) {
    for (int x = 40; x < kWidth - 40; x += 7) {
      const Eigen::Vector2d from(x + 0.3, y + 0.6);
      AffineAlignment start;
      start.position = change.after(from) + Eigen::Vector2d(0.6, -0.5);
      const auto aligned = alignAffine(before.grey.front(), after.grey.front(), from, start,
                                       settings.iterations, settings.convergence);
      ++errors.attempted;
      if (!aligned || aligned->correlation < settings.minimum_correlation) continue;
      ++errors.aligned;
      const Eigen::Vector2d error = aligned->position - change.after(from);
      errors.x.add(error.x());
      errors.y.add(error.y());
      errors.warp.add((aligned->warp - change.warp).norm());
    }
  }
  return errors;
}

void expectAligned(const Change& change) {
  const AlignmentErrors errors = alignGrid(change);
  EXPECT_GT(errors.aligned, 0.95 * errors.attempted);
  EXPECT_LT(std::abs(errors.x.mean()), 0.015);
  EXPECT_LT(std::abs(errors.y.mean()), 0.015);
  EXPECT_LT(errors.x.stddev(), 0.05);
  EXPECT_LT(errors.y.stddev(), 0.05);
  EXPECT_LT(errors.warp.mean(), 0.03);
}

TEST(AffineAlignment, RecoversAShift) {
  expectAligned({.shift = {4.3, -2.8}});
}

TEST(AffineAlignment, RecoversScaleAndRotation) {
  Eigen::Matrix2d warp;
  warp << 1.15, -0.08, 0.06, 1.1;
  expectAligned({.warp = warp, .shift = {1.4, 2.7}});
}

TEST(AffineAlignment, IsInvariantToGainAndBrightness) {
  expectAligned({.shift = {4.3, 0.0}, .gain = 0.4, .brightness = 90.0});
  expectAligned({.shift = {4.3, 0.0}, .gain = 1.4, .brightness = -60.0});
}

/// The right view of a surface whose disparity changes by so much per row and per column.
Change slope(double per_row, double per_column) {
  Change change;
  change.warp << 1.0 - per_column, -per_row, 0.0, 1.0;
  change.shift = {-9.4, 0.0};
  return change;
}

TEST(AffineAlignment, RecoversTheSlopeOfTheDisparity) {
  expectAligned(slope(0.3, 0.0));
  expectAligned(slope(-0.3, 0.0));
  expectAligned(slope(0.0, 0.15));
  expectAligned(slope(0.2, -0.1));
}

/// Mean forward-backward error of patches across a vertical edge right of which the texture moves by another
/// `step` px.
double forwardBackwardErrorAtAnEdge(double step) {
  const test::WaveTexture texture(23);
  const auto changed = [&](double x, double y) { return texture(x > 0.5 * kWidth ? x - step : x, y); };
  const ImagePyramid before = buildPyramid(test::draw(kWidth, kHeight, texture), 1);
  const ImagePyramid after = buildPyramid(test::draw(kWidth, kHeight, changed), 1);
  const TrackingSettings settings;
  test::Statistics miss;
  for (int y = 40; y < kHeight - 40; y += 3) {
    AffineAlignment start;
    start.position = {0.5 * kWidth, y};
    const auto aligned = alignAffine(before.grey.front(), after.grey.front(), start.position, start,
                                     settings.iterations, settings.convergence);
    if (aligned) miss.add(aligned->forward_backward_error);
  }
  return miss.mean();
}

TEST(AffineAlignment, HasALargeForwardBackwardErrorAcrossTwoSurfaces) {
  EXPECT_LT(forwardBackwardErrorAtAnEdge(0.0), 0.02);
  EXPECT_GT(forwardBackwardErrorAtAnEdge(4.0), 0.05);
}

TEST(AffineAlignment, GivesTheSameResultsTogetherAsAlone) {
  Eigen::Matrix2d warp;
  warp << 1.15, -0.08, 0.06, 1.1;
  const Change change = {.warp = warp, .shift = {1.4, 2.7}, .gain = 0.8};
  const test::WaveTexture texture(23);
  const auto changed = [&](double x, double y) {
    const Eigen::Vector2d source = change.before({x, y});
    return change.gain * texture(source.x(), source.y());
  };
  const ImagePyramid before = buildPyramid(test::draw(kWidth, kHeight, texture), 1);
  const ImagePyramid after = buildPyramid(test::draw(kWidth, kHeight, changed), 1);
  // Starts that converge in few or many iterations, that diverge, and that lie outside the image.
  std::vector<AlignmentTask> tasks;
  for (int i = 0; i < 23; ++i) {
    AlignmentTask task = {&before.grey.front(), &after.grey.front(), {40.3 + 7.0 * i, 60.6 + i}, {}};
    task.start.position = change.after(task.from) + Eigen::Vector2d(0.3 * (i % 7), -0.2 * (i % 4));
    if (i % 9 == 4) task.start.position.x() = -20.0;
    tasks.push_back(task);
  }
  int aligned = 0;
  for (const std::size_t count : {1UL, 2UL, 4UL, 7UL, tasks.size()}) {
    std::vector<std::optional<AffineAlignment>> together(count);
    alignAffine(std::span(tasks).first(count), 6, 0.1, together);
    for (std::size_t i = 0; i < count; ++i) {
      const auto alone =
          alignAffine(*tasks[i].before, *tasks[i].after, tasks[i].from, tasks[i].start, 6, 0.1);
      ASSERT_EQ(together[i].has_value(), alone.has_value()) << i << " of " << count;
      if (!alone) continue;
      ++aligned;
      EXPECT_EQ(together[i]->position, alone->position);
      EXPECT_EQ(together[i]->variance, alone->variance);
      EXPECT_EQ(together[i]->warp, alone->warp);
      EXPECT_EQ(together[i]->correlation, alone->correlation);
      EXPECT_EQ(together[i]->forward_backward_error, alone->forward_backward_error);
    }
  }
  EXPECT_GT(aligned, 20);
}

TEST(AffineAlignment, VarianceAgreesWithTheScatterUnderNoise) {
  // Strong gradients along columns, weak ones along rows: the column of a patch is better determined than its
  // row.
  constexpr double kNoise = 4.0;  // grey values
  test::Noise noise(7);
  const auto noisy = [&](double x, double y) {
    return 128.0 + 40.0 * std::sin(0.7 * x) + 30.0 * std::sin(0.25 * y + 0.1 * x) + kNoise * noise.gaussian();
  };
  const ImagePyramid before = buildPyramid(test::draw(kWidth, kHeight, noisy), 1);
  const ImagePyramid after = buildPyramid(test::draw(kWidth, kHeight, noisy), 1);
  test::Statistics column, row, column_variance, row_variance;
  for (int y = 30; y < kHeight - 30; y += 5) {
    for (int x = 30; x < kWidth - 30; x += 5) {
      AffineAlignment start;
      start.position = {x + 0.3, y + 0.6};
      const auto aligned =
          alignAffine(before.grey.front(), after.grey.front(), start.position, start, 20, 0.01);
      if (!aligned) continue;
      column.add(aligned->position.x() - start.position.x());
      row.add(aligned->position.y() - start.position.y());
      column_variance.add(aligned->variance.x());
      row_variance.add(aligned->variance.y());
    }
  }
  ASSERT_GT(column.count(), 800);
  EXPECT_LT(3.0 * column.stddev(), row.stddev());
  // Noise in the gradients, which the variance leaves out, adds to the scatter, most where gradients are
  // weak.
  for (const double ratio :
       {std::sqrt(column_variance.mean()) / column.stddev(), std::sqrt(row_variance.mean()) / row.stddev()}) {
    EXPECT_GT(ratio, 0.5);
    EXPECT_LT(ratio, 1.1);
  }
}

TEST(AffineAlignment, RejectsPatchesWithoutTextureOrThatDiverge) {
  const ImagePyramid grey = buildPyramid(cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(128)), 1);
  const ImagePyramid stripes = buildPyramid(
      test::draw(kWidth, kHeight, [](double x, double) { return 128.0 + 60.0 * std::sin(0.5 * x); }), 1);
  AffineAlignment start;
  start.position = Change::centre();
  for (const ImagePyramid& image : {grey, stripes})
    EXPECT_FALSE(alignAffine(image.grey.front(), image.grey.front(), Change::centre(), start, 30, 0.01));

  const AlignmentErrors other = alignGrid({.warp = 2.5 * Eigen::Matrix2d::Identity()});
  EXPECT_LT(other.aligned, 0.1 * other.attempted);
}

}  // namespace
}  // namespace cartvo::vo
