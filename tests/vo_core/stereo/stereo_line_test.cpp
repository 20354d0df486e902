// The stereo match where the right camera has moved on: along a line that is not the row.
#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/stereo/stereo_matcher.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 400, kHeight = 160;

/// A scene whose disparity changes from column to column of the right image, seen under a line.
struct View {
  EpipolarLine line{};
  double disparity = 12.0;  // px, at the right image's middle
  double slope = 0.0;       // px per column

  double disparityAt(const Eigen::Vector2d& right) const {
    return disparity + slope * (right.x() - 0.5 * kWidth);
  }
  /// The left pixel of a right one.
  Eigen::Vector2d leftOf(const Eigen::Vector2d& right) const {
    return right - line.at(Eigen::Vector2d::Zero(), disparityAt(right));
  }
};

struct LineErrors {
  test::Statistics x, y, disparity;
  int asked = 0, found = 0;
};

/// Matches a grid of points, of which it knows where they are, along `searched`.
LineErrors matchGrid(const View& view, const EpipolarLine& searched) {
  const test::WaveTexture texture(17);
  const ImagePyramid left = buildPyramid(test::draw(kWidth, kHeight, texture), 1);
  const ImagePyramid right = buildPyramid(test::draw(kWidth, kHeight,
                                                     [&](double x, double y) {
                                                       const Eigen::Vector2d source = view.leftOf({x, y});
                                                       return texture(source.x(), source.y());
                                                     }),
                                          1);
  LineErrors errors;
  for (int y = 40; y < kHeight - 40; y += 6) {
    for (int x = 60; x < kWidth - 100; x += 6) {
      const Eigen::Vector2d truth(x + 0.4, y + 0.3);
      const auto match = matchStereo(left, right, view.leftOf(truth), StereoSettings{}, searched);
      ++errors.asked;
      if (!match) continue;
      const Eigen::Vector2d error = match->right - truth;
      if (error.norm() > 1.5) continue;
      ++errors.found;
      errors.x.add(error.x());
      errors.y.add(error.y());
      errors.disparity.add(match->disparity - view.disparityAt(truth));
    }
  }
  return errors;
}

void expectFoundOnlyAlongTheLine(const View& view) {
  const LineErrors errors = matchGrid(view, view.line);
  EXPECT_GT(errors.found, 0.8 * errors.asked);
  EXPECT_LT(std::abs(errors.x.mean()), 0.03);
  EXPECT_LT(errors.x.stddev(), 0.1);
  EXPECT_LT(std::abs(errors.y.mean()), 0.2);  // rows are whole ones: the alignment comes after
  EXPECT_LT(errors.y.stddev(), 0.2);
  EXPECT_LT(std::abs(errors.disparity.mean()), 0.05);
  EXPECT_LT(errors.disparity.stddev(), 0.15);
  const int by_rows = matchGrid(view, EpipolarLine{}).found;
  EXPECT_LT(by_rows, 0.05 * errors.asked);
}

TEST(StereoLine, FindsWhatAPitchBetweenTheInstantsHasMovedByRows) {
  expectFoundOnlyAlongTheLine({.line = {{0.0, 7.0}, {0.0, 0.0}}});
  expectFoundOnlyAlongTheLine({.line = {{0.0, -6.4}, {0.0, 0.0}}});
}

TEST(StereoLine, FindsWhatATurnHasMovedBeyondTheRangeOfDisparities) {
  // To the right of where it is in the left image: a disparity of -13 px by the row.
  expectFoundOnlyAlongTheLine({.line = {{25.0, 0.0}, {0.0, 0.0}}});
}

TEST(StereoLine, FindsWhatMovesOffTheRowTheMoreTheNearerItIs) {
  for (const double disparity : {5.0, 14.0, 26.5})
    expectFoundOnlyAlongTheLine({.line = {{1.5, -4.0}, {-0.1, -0.25}}, .disparity = disparity});
}

TEST(StereoLine, FindsASurfaceThatComesNearer) {
  expectFoundOnlyAlongTheLine({.line = {{2.0, 3.0}, {0.1, 0.2}}, .disparity = 15.0, .slope = 0.03});
}

TEST(StereoLine, WithoutALineTheRightPixelLiesOnTheRow) {
  const View view{.disparity = 9.3};
  const LineErrors errors = matchGrid(view, EpipolarLine{});
  EXPECT_GT(errors.found, 0.9 * errors.asked);
  EXPECT_LT(std::abs(errors.x.mean()), 0.02);
  EXPECT_LT(errors.x.stddev(), 0.06);
  EXPECT_EQ(errors.y.stddev(), 0.0);
  EXPECT_LT(std::abs(errors.x.mean() + errors.disparity.mean()), 1e-9);  // one is the other
}

TEST(StereoLine, IsMeasuredByTheDisparityAlongIt) {
  const EpipolarLine line{{2.0, -3.0}, {0.1, 0.5}};
  EXPECT_EQ(line.at({100.0, 50.0}, 0.0), Eigen::Vector2d(102.0, 47.0));
  EXPECT_LT((line.at({100.0, 50.0}, 10.0) - Eigen::Vector2d(93.0, 52.0)).norm(), 1e-12);
  EXPECT_EQ(EpipolarLine{}.at({100.0, 50.0}, 10.0), Eigen::Vector2d(90.0, 50.0));
}

}  // namespace
}  // namespace cartvo::vo
