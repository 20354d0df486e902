#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "tools/report/drawing.hpp"

// Charts: panels one above the other with a common x axis, round ticks, units and one legend.

namespace cartvo {

/// Colours of charts that readers with colour blindness can tell apart (M. Okabe, K. Ito, 2008).
inline constexpr DrawingColour kChartInk{34, 34, 34}, kChartGrid{222, 222, 222}, kChartBlue{0, 114, 178},
    kChartRed{213, 94, 0}, kChartGreen{0, 158, 115};

/// Names of these colours for svgElement(), and the style rules that define them for light and dark pages.
ColourNames chartColourNames();
std::string chartColourStyle();

/// How a series is drawn.
enum class SeriesStyle : std::uint8_t { line, dashed, dots };

/// Values over x. A value that is not finite interrupts the line.
struct ChartSeries {
  std::string name;  ///< in the legend
  DrawingColour colour;
  std::vector<cv::Point2d> points;
  SeriesStyle style = SeriesStyle::line;
};

/// Area between two curves over x, or between the values of a constant interval.
struct ChartBand {
  struct Limits {
    double x = 0.0, low = 0.0, high = 0.0;
  };
  std::string name;  ///< in the legend
  DrawingColour colour;
  std::vector<Limits> limits;  ///< a limit that is not finite interrupts the band
};

/// Part of the x axis.
struct ChartSpan {
  double from = 0.0, to = 0.0;
};

/// One y axis with its curves.
struct ChartPanel {
  std::string y_title;  ///< with the unit
  std::vector<ChartSeries> series;
  std::vector<ChartBand> bands;  ///< cut off at the axis' ends; they do not widen it beyond twice the series
  bool is_logarithmic = false;   ///< values that are not positive are left out
  bool contains_zero = false;    ///< whether the linear axis begins at or crosses 0 in any case
  int height = 150;              ///< px
};

struct Chart {
  std::string title, x_title;
  std::vector<ChartPanel> panels;
  std::vector<ChartSpan> marked;           ///< a bar below the panels shows them in the colour of faults
  std::string marked_name, unmarked_name;  ///< of the bar's parts in the legend; empty: no bar
  bool has_equal_scale = false;            ///< x and y have the same unit and scale
  bool is_x_logarithmic = false;           ///< values of x that are not positive are left out
};

/// Draws a chart, 600 px wide. Curves of many points are reduced to what is visible at that width.
Drawing drawChart(const Chart& chart);

}  // namespace cartvo
