// Draws diagrams as SVG.

#include "tools/report/diagram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace cartvo {
namespace {

using Point = DiagramCurve::Point;

std::string format(const char* pattern, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// Maps values to pixels inside a diagram's frame.
struct Axes {
  const Diagram& frame;
  double x_low = 0.0, x_high = 1.0;
  double y_low = 1e9, y_high = 0.0;  ///< powers of ten

  explicit Axes(const Diagram& diagram) : frame(diagram) {
    for (const DiagramCurve& curve : diagram.curves) {
      for (const Point& point : curve.points) {
        x_low = std::min(x_low, point.x);
        x_high = std::max(x_high, point.x);
        y_low = std::min(y_low, point.y);
        y_high = std::max(y_high, point.y);
      }
    }
    constexpr double kMinValue = 1e-6;
    y_low = std::pow(10.0, std::floor(std::log10(std::max(y_low, kMinValue))));
    y_high = std::pow(10.0, std::ceil(std::log10(std::max(y_high, 1.01 * y_low))));
  }

  Point at(const Point& value) const {
    const double across = (value.x - x_low) / (x_high - x_low);
    const double up = (std::log10(value.y) - std::log10(y_low)) / (std::log10(y_high) - std::log10(y_low));
    return {frame.left + across * frame.width, frame.top + (1.0 - up) * frame.height};
  }
};

std::string line(const Point& from, const Point& to) {
  return format("<path d=\"M%.1f %.1fL%.1f %.1f\" stroke=\"#ddd\"/>\n", from.x, from.y, to.x, to.y);
}

std::string drawAxes(const Axes& axes) {
  const Diagram& frame = axes.frame;
  std::string svg;
  for (double y = axes.y_low; y <= 1.001 * axes.y_high; y *= 10.0) {
    const Point from = axes.at({axes.x_low, y}), to = axes.at({axes.x_high, y});
    svg += line(from, to) + svgText(from.x - 6, from.y + 4, "end", format("%g", y));
  }
  for (double x = frame.x_step * std::ceil(axes.x_low / frame.x_step); x <= axes.x_high; x += frame.x_step) {
    const Point low = axes.at({x, axes.y_low}), high = axes.at({x, axes.y_high});
    svg += line(low, high) + svgText(low.x, low.y + 16, "middle", format("%g", x));
  }
  return svg + svgText(frame.left, frame.top - 8, "start", frame.title) +
         svgText(frame.left + frame.width, frame.top + frame.height + 32, "end", frame.x_title);
}

std::string drawCurve(const Axes& axes, const DiagramCurve& curve) {
  std::string svg = "<path d=\"";
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Point at = axes.at(curve.points[i]);
    svg += format(i == 0 ? "M%.1f %.1f" : "L%.1f %.1f", at.x, at.y);
  }
  return svg + format("\" fill=\"none\" stroke=\"%s\" stroke-width=\"%g\" stroke-opacity=\"%g\"/>\n",
                      curve.colour.c_str(), curve.width, curve.opacity);
}

}  // namespace

std::string svgText(double x, double y, const char* anchor, const std::string& letters) {
  return format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x, y, anchor, letters.c_str());
}

std::string svgLegendEntry(double x, double y, const std::string& colour, const std::string& name) {
  return format("<path d=\"M%.1f %.1fh30\" stroke=\"%s\" stroke-width=\"3\"/>\n", x, y, colour.c_str()) +
         svgText(x + 36, y + 4, "start", name);
}

std::string svgFile(int width, int height, const std::string& elements) {
  return format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
             "font-size=\"13\">\n<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
             width, height, width, height) +
         elements + "</svg>\n";
}

std::string svgDiagram(const Diagram& diagram) {
  const Axes axes(diagram);
  std::string svg = drawAxes(axes);
  for (const DiagramCurve& curve : diagram.curves)
    svg += drawCurve(axes, curve);
  return svg;
}

}  // namespace cartvo
