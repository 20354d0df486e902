// Charts: axes with units, legend, interruptions, reduction of long curves.
#include "tools/report/chart.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/report/axis.hpp"
#include "tools/report/series_reduction.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Axis, HasRoundSteps) {
  EXPECT_DOUBLE_EQ(roundStep(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(roundStep(0.07, 7), 0.01);
  EXPECT_DOUBLE_EQ(roundStep(33.0, 10), 5.0);
  EXPECT_THAT(multiplesOf(0.5, -0.6, 1.0), ElementsAre(DoubleNear(-0.5, 1e-12), DoubleNear(0.0, 1e-12),
                                                       DoubleNear(0.5, 1e-12), DoubleNear(1.0, 1e-12)));
  EXPECT_EQ(tickLabel(0.5, 0.25), "0.5");
  EXPECT_EQ(tickLabel(-1e-12, 0.1), "0.0");
}

Chart example() {
  Chart chart;
  chart.title = "Speed & time";
  chart.x_title = "time (s)";
  ChartPanel panel;
  panel.y_title = "speed (m/s)";
  panel.series = {{"truth", kChartInk, {{0, 1}, {1, 2}, {2, 3}}, SeriesStyle::dashed},
                  {"estimate", kChartBlue, {{0, 1}, {1, kNaN}, {2, 3}}}};
  panel.bands = {{"±2 σ", kChartBlue, {{0, 0.5, 1.5}, {1, kNaN, kNaN}, {2, 2.5, 3.5}}}};
  chart.panels = {panel};
  chart.marked = {{0.5, 1.0}};
  chart.marked_name = "not valid";
  chart.unmarked_name = "valid";
  return chart;
}

TEST(Chart, HasTitlesUnitsAndOneLegend) {
  Chart chart = example();
  chart.panels.push_back(chart.panels.front());
  const std::string svg = drawChart(chart).svg();
  EXPECT_THAT(svg, AllOf(HasSubstr("Speed &amp; time"), HasSubstr("time (s)"), HasSubstr("speed (m/s)"),
                         HasSubstr("±2 σ"), HasSubstr("not valid"), HasSubstr("stroke-dasharray"),
                         Not(HasSubstr("nan"))));
  EXPECT_EQ(svg.find(">truth<"), svg.rfind(">truth<"));
}

TEST(Chart, TakesThePagesColoursAsAnElement) {
  const std::string svg = drawChart(example()).svgElement("Speed", chartColourNames());
  EXPECT_THAT(svg, AllOf(HasSubstr("<title>Speed</title>"), HasSubstr("stroke=\"var(--blue)\""),
                         Not(HasSubstr("#0072b2")), Not(HasSubstr("xmlns"))));
}

TEST(Chart, LeavesOutMarksBesideTheRangeOfItsPanels) {
  const auto red_shapes = [](const ChartSpan& span) {
    Chart chart = example();
    chart.marked = {span};
    const std::string svg = drawChart(chart).svgElement("Speed", chartColourNames());
    int count = 0;
    for (std::size_t at = 0; (at = svg.find("var(--red)", at)) != std::string::npos; ++at)
      ++count;
    return count;
  };
  const int inside = red_shapes({0.5, 1.0});
  EXPECT_EQ(red_shapes({-5.0, -4.0}), inside - 1);
  EXPECT_EQ(red_shapes({5.0, 6.0}), inside - 1);
  EXPECT_EQ(red_shapes({-5.0, 6.0}), inside);
}

TEST(Chart, OfNothingAndOfOneValueIsDrawn) {
  Chart chart;
  chart.panels.emplace_back();
  EXPECT_THAT(drawChart(chart).svg(), Not(HasSubstr("nan")));
  chart.panels.front().is_logarithmic = true;
  chart.panels.front().series = {{"one", kChartBlue, {{0.0, 0.0}, {1.0, 1e300}, {2.0, 5.0}}}};
  EXPECT_THAT(drawChart(chart).svg(), AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
  chart.has_equal_scale = true;
  chart.panels.front().is_logarithmic = false;
  chart.panels.front().series = {{"one", kChartBlue, {{3.0, 3.0}}, SeriesStyle::dots}};
  EXPECT_THAT(drawChart(chart).svg(), Not(HasSubstr("nan")));
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
  EXPECT_EQ(visibleAreas({{0, 1}, {1, 1}, {2, kNaN}, {3, 1}}, {{0, 0}, {1, 0}, {2, 0}, {3, 0}}).size(), 2u);
}

}  // namespace
}  // namespace cartvo
