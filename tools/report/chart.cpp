// Draws charts: axes, legend, curves, bands.
#include "tools/report/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/report/axis.hpp"
#include "tools/report/series_reduction.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

constexpr int kWidth = 600, kLetterSize = 15;
constexpr double kLeft = 62.0, kRight = 14.0, kTitleHeight = 28.0, kLegendHeight = 24.0;  // px
constexpr double kPanelTitle = 27.0, kTickHeight = 22.0, kXTitleHeight = 24.0, kMarkHeight = 12.0;
constexpr double kPlotWidth = kWidth - kLeft - kRight;
constexpr double kLineWidth = 1.8, kDotRadius = 3.5, kBandOpacity = 0.22;
constexpr double kLetterWidth = 0.56 * kLetterSize;  // mean, for the layout of the legend

/// An axis from `low` to `high`.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool isEmpty() const { return low > high; }
  double size() const { return high - low; }
};

/// Widens a range without extent, or gives an empty one, so that it can be divided by its size.
Range usable(Range range) {
  if (range.isEmpty()) return {0.0, 1.0};
  const double least = 1e-6 * std::max(1.0, std::abs(range.high));
  if (range.size() >= least) return range;
  const double margin = range.high == 0.0 ? 1.0 : 0.5 * std::abs(range.high);
  return {range.low - margin, range.high + margin};
}

/// Full decades that contain the logarithms of a range, at most eight.
Range decades(const Range& range) {
  if (range.isEmpty()) return {-1.0, 1.0};
  constexpr double kMaxDecades = 8.0;
  const double high = std::max(std::ceil(range.high), std::floor(range.low) + 1.0);
  return {std::max(std::floor(range.low), high - kMaxDecades), high};
}

/// Of logarithms if the axis is logarithmic.
Range xRange(const Chart& chart) {
  Range range;
  for (const ChartPanel& panel : chart.panels) {
    for (const ChartSeries& series : panel.series) {
      for (const cv::Point2d& point : series.points)
        range.include(chart.is_x_logarithmic ? std::log10(point.x) : point.x);  // not finite: left out
    }
  }
  return chart.is_x_logarithmic ? decades(range) : usable(range);
}

Range linearRange(const ChartPanel& panel) {
  Range range;
  for (const ChartSeries& series : panel.series) {
    for (const cv::Point2d& point : series.points)
      range.include(point.y);
  }
  if (panel.contains_zero) range.include(0.0);
  const Range of_series = usable(range);
  Range with_bands = of_series;
  for (const ChartBand& band : panel.bands) {
    for (const ChartBand::Limits& limits : band.limits) {
      with_bands.include(limits.low);
      with_bands.include(limits.high);
    }
  }
  constexpr double kMaxWidening = 0.5;  // of the series' range, on each side
  with_bands.low = std::max(with_bands.low, of_series.low - kMaxWidening * of_series.size());
  with_bands.high = std::min(with_bands.high, of_series.high + kMaxWidening * of_series.size());
  if (panel.contains_zero && of_series.low >= 0.0) with_bands.low = 0.0;
  constexpr double kMargin = 0.06;
  const double margin = kMargin * with_bands.size();
  return {with_bands.low == 0.0 ? 0.0 : with_bands.low - margin, with_bands.high + margin};
}

Range logarithmicRange(const ChartPanel& panel) {
  Range range;
  const auto include = [&](double value) {
    if (value > 0.0) range.include(std::log10(value));
  };
  for (const ChartSeries& series : panel.series) {
    for (const cv::Point2d& point : series.points)
      include(point.y);
  }
  for (const ChartBand& band : panel.bands) {
    for (const ChartBand::Limits& limits : band.limits) {
      include(limits.low);
      include(limits.high);
    }
  }
  return decades(range);
}

/// Maps the values of a panel to px of the drawing.
class PanelMap {
 public:
  /// `x`: see xRange.
  PanelMap(const ChartPanel& panel, const Range& x, bool is_x_logarithmic, double top)
      : is_logarithmic_(panel.is_logarithmic),
        is_x_logarithmic_(is_x_logarithmic),
        x_(x),
        y_(panel.is_logarithmic ? logarithmicRange(panel) : linearRange(panel)),
        top_(top),
        height_(panel.height) {}

  const Range& x() const { return x_; }
  const Range& y() const { return y_; }
  double top() const { return top_; }
  double bottom() const { return top_ + height_; }
  bool isLogarithmic() const { return is_logarithmic_; }
  bool isXLogarithmic() const { return is_x_logarithmic_; }

  /// Gives both axes the same scale; the smaller range is widened about its centre.
  void equalise() {
    const double scale = std::max(x_.size() / kPlotWidth, y_.size() / height_);
    const auto widen = [scale](Range& range, double pixels) {
      const double centre = 0.5 * (range.low + range.high);
      range = {centre - 0.5 * scale * pixels, centre + 0.5 * scale * pixels};
    };
    constexpr double kMargin = 1.0;
    widen(x_, kMargin * kPlotWidth);
    widen(y_, kMargin * height_);
  }

  double across(double x) const {
    const double value = is_x_logarithmic_ ? std::log10(x) : x;
    return kLeft + (value - x_.low) / x_.size() * kPlotWidth;
  }
  /// Values outside the axis are at its ends; NaN stays NaN.
  double down(double y) const {
    const double value = is_logarithmic_ ? std::log10(y) : y;
    return std::isnan(value) ? value
                             : bottom() - std::clamp((value - y_.low) / y_.size(), 0.0, 1.0) * height_;
  }
  cv::Point2d operator()(const cv::Point2d& value) const { return {across(value.x), down(value.y)}; }

 private:
  bool is_logarithmic_, is_x_logarithmic_;
  Range x_, y_;
  double top_, height_;
};

/// Label of a power of ten.
std::string decadeLabel(double exponent) {
  const double value = std::pow(10.0, exponent);
  return exponent < 0.0 ? tickLabel(value, value) : fixed(value, 0);
}

void drawYAxis(Drawing& drawing, const PanelMap& map, const std::string& title) {
  const double step =
      map.isLogarithmic() ? std::max(1.0, std::ceil(map.y().size() / 4.0)) : roundStep(map.y().size(), 5);
  for (const double y : multiplesOf(step, map.y().low, map.y().high)) {
    const double value = map.isLogarithmic() ? std::pow(10.0, y) : y;
    const double down = map.down(value);
    drawing.addLine({{kLeft, down}, {kWidth - kRight, down}}, kChartGrid, 1.0);
    drawing.addText({kLeft - 7.0, down + 0.35 * kLetterSize}, TextAnchor::end,
                    map.isLogarithmic() ? decadeLabel(y) : tickLabel(y, step), kChartInk);
  }
  drawing.addText({kLeft, map.top() - 8.0}, TextAnchor::start, title, kChartInk);
}

void drawXGrid(Drawing& drawing, const PanelMap& map, bool with_labels) {
  constexpr int kParts = 7;
  const double step = map.isXLogarithmic() ? 1.0 : roundStep(map.x().size(), kParts);
  for (const double x : multiplesOf(step, map.x().low, map.x().high)) {
    const double across = map.across(map.isXLogarithmic() ? std::pow(10.0, x) : x);
    drawing.addLine({{across, map.top()}, {across, map.bottom()}}, kChartGrid, 1.0);
    if (!with_labels) continue;
    drawing.addText({across, map.bottom() + 17.0}, TextAnchor::middle,
                    map.isXLogarithmic() ? decadeLabel(x) : tickLabel(x, step), kChartInk);
  }
}

void drawFrame(Drawing& drawing, const PanelMap& map) {
  const cv::Point2d low(kLeft, map.top()), high(kWidth - kRight, map.bottom());
  drawing.addLine({low, {high.x, low.y}, high, {low.x, high.y}, low}, kChartInk, 1.0);
}

void drawSeries(Drawing& drawing, const PanelMap& map, const ChartSeries& series) {
  if (series.style == SeriesStyle::dots) {
    for (const cv::Point2d& point : series.points) {
      if (const cv::Point2d at = map(point); std::isfinite(at.x) && std::isfinite(at.y))
        drawing.addCircle(at, kDotRadius, series.colour, 0.0);
    }
    return;
  }
  const LinePattern pattern = series.style == SeriesStyle::dashed ? LinePattern::dashed : LinePattern::solid;
  std::vector<cv::Point2d> pixels;
  for (const cv::Point2d& point : series.points)
    pixels.push_back(map(point));
  for (std::vector<cv::Point2d>& part : visibleParts(pixels))
    drawing.addLine(std::move(part), series.colour, kLineWidth, pattern);
}

void drawBand(Drawing& drawing, const PanelMap& map, const ChartBand& band) {
  std::vector<cv::Point2d> low, high;
  for (const ChartBand::Limits& limits : band.limits) {
    low.push_back(map({limits.x, limits.low}));
    high.push_back(map({limits.x, limits.high}));
  }
  for (std::vector<cv::Point2d>& outline : visibleAreas(low, high))
    drawing.addArea(std::move(outline), band.colour, kBandOpacity);
}

struct LegendEntry {
  std::string name;
  DrawingColour colour;
  enum class Kind : std::uint8_t { line, dashed, dots, band } kind;
};

/// The distinct names of all panels.
std::vector<LegendEntry> legendOf(const Chart& chart) {
  std::vector<LegendEntry> legend;
  const auto add = [&](const std::string& name, DrawingColour colour, LegendEntry::Kind kind) {
    const bool is_known = std::any_of(legend.begin(), legend.end(),
                                      [&](const LegendEntry& entry) { return entry.name == name; });
    if (!is_known && !name.empty()) legend.push_back({name, colour, kind});
  };
  for (const ChartPanel& panel : chart.panels) {
    for (const ChartSeries& series : panel.series)
      add(series.name, series.colour, static_cast<LegendEntry::Kind>(series.style));
    for (const ChartBand& band : panel.bands)
      add(band.name, band.colour, LegendEntry::Kind::band);
  }
  add(chart.unmarked_name, kChartGreen, LegendEntry::Kind::band);
  if (!chart.marked.empty()) add(chart.marked_name, kChartRed, LegendEntry::Kind::band);
  return legend;
}

constexpr double kSample = 26.0, kSampleGap = 7.0, kEntryGap = 18.0;  // px

/// Positions of the entries, row by row; the second value is the number of rows.
std::pair<std::vector<cv::Point2d>, int> legendLayout(const std::vector<LegendEntry>& legend) {
  std::vector<cv::Point2d> places;
  double x = kLeft;
  int row = 0;
  for (const LegendEntry& entry : legend) {
    const double width =
        kSample + kSampleGap + kLetterWidth * static_cast<double>(entry.name.size()) + kEntryGap;
    if (x > kLeft && x + width - kEntryGap > kWidth) {
      x = kLeft;
      ++row;
    }
    places.emplace_back(x, kTitleHeight + kLegendHeight * (row + 0.55));
    x += width;
  }
  return {places, legend.empty() ? 0 : row + 1};
}

void drawLegend(Drawing& drawing, const std::vector<LegendEntry>& legend,
                const std::vector<cv::Point2d>& places) {
  for (std::size_t i = 0; i < legend.size(); ++i) {
    const cv::Point2d from = places[i], to = from + cv::Point2d(kSample, 0.0);
    switch (legend[i].kind) {
      case LegendEntry::Kind::band:
        drawing.addArea({from + cv::Point2d(0, -6), to + cv::Point2d(0, -6), to + cv::Point2d(0, 6),
                         from + cv::Point2d(0, 6)},
                        legend[i].colour, legend[i].colour == kChartRed ? 1.0 : kBandOpacity);
        break;
      case LegendEntry::Kind::dots:
        drawing.addCircle((from + to) / 2.0, kDotRadius, legend[i].colour, 0.0);
        break;
      case LegendEntry::Kind::line:
      case LegendEntry::Kind::dashed:
        drawing.addLine(
            {from, to}, legend[i].colour, kLineWidth + 0.7,
            legend[i].kind == LegendEntry::Kind::dashed ? LinePattern::dashed : LinePattern::solid);
    }
    drawing.addText(to + cv::Point2d(kSampleGap, 0.35 * kLetterSize), TextAnchor::start, legend[i].name,
                    kChartInk);
  }
}

/// Bar in which the marked parts are filled, as far as they are in the range of the panels.
void drawMarks(Drawing& drawing, const Chart& chart, const PanelMap& map, double top) {
  const double bottom = top + kMarkHeight;
  drawing.addArea({{kLeft, top}, {kWidth - kRight, top}, {kWidth - kRight, bottom}, {kLeft, bottom}},
                  kChartGreen, kBandOpacity);
  constexpr double kMinWidth = 1.5;  // px, so that a single pair is seen
  for (const ChartSpan& span : chart.marked) {
    if (map.across(span.to) < kLeft || map.across(span.from) > kWidth - kRight) continue;
    const double from = std::clamp(map.across(span.from), kLeft, kWidth - kRight - kMinWidth);
    const double to = std::clamp(map.across(span.to), from + kMinWidth, kWidth - kRight);
    drawing.addArea({{from, top}, {to, top}, {to, bottom}, {from, bottom}}, kChartRed, 1.0);
  }
}

}  // namespace

ColourNames chartColourNames() {
  return {{kChartInk, "var(--ink)"},
          {kChartGrid, "var(--grid)"},
          {kChartBlue, "var(--blue)"},
          {kChartRed, "var(--red)"},
          {kChartGreen, "var(--green)"}};
}

std::string chartColourStyle() {
  return ":root{--ink:#222;--grid:#dedede;--blue:#0072b2;--red:#d55e00;--green:#009e73}"
         "@media screen and (prefers-color-scheme:dark){"
         ":root{--ink:#e4e4e4;--grid:#454545;--blue:#56b4e9;--red:#ff8c3a;--green:#2fd0a0}}";
}

Drawing drawChart(const Chart& chart) {
  const std::vector<LegendEntry> legend = legendOf(chart);
  const auto [places, rows] = legendLayout(legend);
  const double first = kTitleHeight + rows * kLegendHeight;
  double bottom = first;
  for (const ChartPanel& panel : chart.panels)
    bottom += kPanelTitle + panel.height;
  const bool has_marks = !chart.marked_name.empty();
  const double marks_top = bottom + kTickHeight;
  const double x_title = marks_top + (has_marks ? kMarkHeight : 0.0) + kXTitleHeight - 6.0;

  Drawing drawing(kWidth, static_cast<int>(x_title + 8.0), kLetterSize);
  drawing.addText({kLeft, 19.0}, TextAnchor::start, chart.title, kChartInk);
  drawLegend(drawing, legend, places);
  const Range x = xRange(chart);
  double top = first;
  for (const ChartPanel& panel : chart.panels) {
    top += kPanelTitle;
    PanelMap map(panel, x, chart.is_x_logarithmic, top);
    if (chart.has_equal_scale) map.equalise();
    drawXGrid(drawing, map, &panel == &chart.panels.back());
    drawYAxis(drawing, map, panel.y_title);
    for (const ChartBand& band : panel.bands)
      drawBand(drawing, map, band);
    for (const ChartSeries& series : panel.series)
      drawSeries(drawing, map, series);
    drawFrame(drawing, map);
    if (has_marks && &panel == &chart.panels.back()) drawMarks(drawing, chart, map, marks_top);
    top += panel.height;
  }
  drawing.addText({kLeft + kPlotWidth, x_title}, TextAnchor::end, chart.x_title, kChartInk);
  return drawing;
}

}  // namespace cartvo
