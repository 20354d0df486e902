// Errors over the offset as a picture.
#include "tools/benchmark/offset_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "tools/benchmark/offset_report.hpp"

namespace cartvo::benchmark {
namespace {

struct Point {
  double x, y;
};

struct Curve {
  OffsetModel model;
  bool of_all = false;  ///< worlds together
  std::vector<Point> points;
};

/// One diagram: values on a logarithmic axis over the offset in ms.
struct Panel {
  std::string title;
  double left, top, width, height;  // px
  double x_low, x_high;             // ms
  double y_low, y_high;             // powers of ten

  Point at(const Point& value) const {
    const double across = (value.x - x_low) / (x_high - x_low);
    const double up = (std::log10(value.y) - std::log10(y_low)) / (std::log10(y_high) - std::log10(y_low));
    return {left + across * width, top + (1.0 - up) * height};
  }
};

const char* colourOf(OffsetModel model) {
  switch (model) {
    case OffsetModel::two_instants:
      return "#145abe";
    case OffsetModel::image_velocity:
      return "#2e8b57";
    default:
      return "#c82828";
  }
}

std::string format(const char* pattern, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string text(double x, double y, const char* anchor, const std::string& letters) {
  return format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x, y, anchor, letters.c_str());
}

std::string line(const Point& from, const Point& to) {
  return format("<path d=\"M%.1f %.1fL%.1f %.1f\" stroke=\"#ddd\"/>\n", from.x, from.y, to.x, to.y);
}

std::string drawAxes(const Panel& panel) {
  std::string svg;
  for (double y = panel.y_low; y <= 1.001 * panel.y_high; y *= 10.0) {
    const Point from = panel.at({panel.x_low, y}), to = panel.at({panel.x_high, y});
    svg += line(from, to) + text(from.x - 6, from.y + 4, "end", format("%g", y));
  }
  for (double x = 5.0 * std::ceil(panel.x_low / 5.0); x <= panel.x_high; x += 5.0) {
    const Point low = panel.at({x, panel.y_low}), high = panel.at({x, panel.y_high});
    svg += line(low, high) + text(low.x, low.y + 16, "middle", format("%g", x));
  }
  return svg + text(panel.left, panel.top - 8, "start", panel.title) +
         text(panel.left + panel.width, panel.top + panel.height + 32, "end", "right camera later by (ms)");
}

std::string drawCurve(const Panel& panel, const Curve& curve) {
  std::string svg = "<path d=\"";
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Point at = panel.at(curve.points[i]);
    svg += format(i == 0 ? "M%.1f %.1f" : "L%.1f %.1f", at.x, at.y);
  }
  return svg + format("\" fill=\"none\" stroke=\"%s\" stroke-width=\"%g\" stroke-opacity=\"%g\"/>\n",
                      colourOf(curve.model), curve.of_all ? 3.0 : 1.0, curve.of_all ? 1.0 : 0.6);
}

std::string drawLegend(const std::vector<Curve>& curves, double y) {
  std::string svg;
  double x = 70.0;
  for (const std::string& name : offsetModelNames()) {
    const OffsetModel model = offsetModelNamed(name);
    if (std::none_of(curves.begin(), curves.end(), [&](const Curve& curve) { return curve.model == model; }))
      continue;
    svg += format("<path d=\"M%.1f %.1fh30\" stroke=\"%s\" stroke-width=\"3\"/>\n", x, y, colourOf(model)) +
           text(x + 36, y + 4, "start", name);
    x += 160.0;
  }
  return svg;
}

/// The curves of one value, in the order of the offset.
std::vector<Curve> curvesOf(const std::vector<OffsetAccuracy>& accuracies, bool of_all,
                            const std::function<double(const SegmentErrors&)>& value) {
  std::vector<Curve> curves;
  std::vector<std::string> sequences;
  for (const OffsetAccuracy& one : accuracies) {
    const SegmentErrors& segments = one.accuracy.evaluation.short_segments.all;
    if (one.clock.drift_ppm != 0.0 || one.accuracy.kind != SequenceKind::rendered || segments.count == 0)
      continue;
    std::size_t index = 0;
    while (index < curves.size() && (sequences[index] != one.sequence || curves[index].model != one.model))
      ++index;
    if (index == curves.size()) {
      curves.push_back({one.model, of_all, {}});
      sequences.push_back(one.sequence);
    }
    curves[index].points.push_back({1e3 * one.clock.offset_s, value(segments)});
  }
  for (Curve& curve : curves)
    std::sort(curve.points.begin(), curve.points.end(),
              [](const Point& a, const Point& b) { return a.x < b.x; });
  return curves;
}

std::string drawPanel(const std::string& title, double top, const std::vector<Curve>& curves) {
  Panel panel{title, 70.0, top, 600.0, 260.0, 0.0, 1.0, 1e9, 0.0};
  for (const Curve& curve : curves) {
    for (const Point& point : curve.points) {
      panel.x_low = std::min(panel.x_low, point.x);
      panel.x_high = std::max(panel.x_high, point.x);
      panel.y_low = std::min(panel.y_low, point.y);
      panel.y_high = std::max(panel.y_high, point.y);
    }
  }
  constexpr double kLeast = 1e-6;
  panel.y_low = std::pow(10.0, std::floor(std::log10(std::max(panel.y_low, kLeast))));
  panel.y_high = std::pow(10.0, std::ceil(std::log10(std::max(panel.y_high, 1.01 * panel.y_low))));
  std::string svg = drawAxes(panel);
  for (const Curve& curve : curves)
    svg += drawCurve(panel, curve);
  return svg;
}

}  // namespace

std::string offsetPlot(const std::vector<OffsetAccuracy>& accuracies) {
  const auto both = [&](const std::function<double(const SegmentErrors&)>& value) {
    std::vector<Curve> curves = curvesOf(accuracies, false, value);
    for (Curve& curve : curvesOf(allWorlds(accuracies), true, value))
      curves.push_back(std::move(curve));
    return curves;
  };
  const std::vector<Curve> translation = both([](const SegmentErrors& e) { return 100.0 * e.translation; });
  const std::vector<Curve> rotation =
      both([](const SegmentErrors& e) { return 180.0 / std::numbers::pi * e.rotation; });
  if (translation.empty())
    throw std::invalid_argument("there is nothing to draw: no world with a constant offset");
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 700 730\" font-family=\"sans-serif\" "
         "font-size=\"13\">\n<rect width=\"700\" height=\"730\" fill=\"#fff\"/>\n" +
         drawLegend(translation, 24.0) + drawPanel("translation over 5 to 40 m (%)", 70.0, translation) +
         drawPanel("rotation over 5 to 40 m (deg/m)", 410.0, rotation) + "</svg>\n";
}

}  // namespace cartvo::benchmark
