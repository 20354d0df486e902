// Axes: round steps. Reduction of long curves.
#include "tools/report/axis.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tools/report/series_reduction.hpp"

namespace cartvo {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Axis, HasRoundSteps) {
  EXPECT_DOUBLE_EQ(roundStep(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(roundStep(0.07, 7), 0.01);
  EXPECT_DOUBLE_EQ(roundStep(33.0, 10), 5.0);
  EXPECT_EQ(tickLabel(0.5, 0.25), "0.5");
  EXPECT_EQ(tickLabel(-1e-12, 0.1), "0.0");
}

TEST(SeriesReduction, KeepsExtremesOfAColumnAndInterruptions) {
  std::vector<cv::Point2d> pixels;
  for (int i = 0; i < 1000; ++i)
    pixels.emplace_back(0.01 * i, i == 500 ? 100.0 : std::sin(i));
  pixels[700].y = kNaN;
  const auto parts = visibleParts(pixels);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_LE(parts[0].size() + parts[1].size(), 4u * 23u);
  const bool has_peak =
      std::any_of(parts[0].begin(), parts[0].end(), [](const auto& point) { return point.y == 100.0; });
  EXPECT_TRUE(has_peak);
}

}  // namespace
}  // namespace cartvo
