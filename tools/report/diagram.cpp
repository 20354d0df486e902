// Diagrams with a logarithmic y axis.

#include "tools/report/diagram.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace cartvo {
namespace {

constexpr DrawingColour kGrid{221, 221, 221};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

/// Maps values to pixels inside a diagram's frame.
struct Axes {
  const Diagram& frame;
  double x_low = 0.0, x_high = 1.0;
  double y_low = 1e9, y_high = 0.0;  ///< powers of ten

  explicit Axes(const Diagram& diagram) : frame(diagram) {
    for (const DiagramCurve& curve : diagram.curves) {
      for (const cv::Point2d& point : curve.points) {
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

  cv::Point2d at(const cv::Point2d& value) const {
    const double across = (value.x - x_low) / (x_high - x_low);
    const double up = (std::log10(value.y) - std::log10(y_low)) / (std::log10(y_high) - std::log10(y_low));
    return {frame.left + across * frame.width, frame.top + (1.0 - up) * frame.height};
  }
};

void addAxes(Drawing& drawing, const Axes& axes) {
  const Diagram& frame = axes.frame;
  for (double y = axes.y_low; y <= 1.001 * axes.y_high; y *= 10.0) {
    const cv::Point2d from = axes.at({axes.x_low, y}), to = axes.at({axes.x_high, y});
    drawing.addLine({from, to}, kGrid, 1.0);
    drawing.addText(from + cv::Point2d(-6.0, 4.0), TextAnchor::end, number(y));
  }
  for (double x = frame.x_step * std::ceil(axes.x_low / frame.x_step); x <= axes.x_high; x += frame.x_step) {
    const cv::Point2d low = axes.at({x, axes.y_low}), high = axes.at({x, axes.y_high});
    drawing.addLine({low, high}, kGrid, 1.0);
    drawing.addText(low + cv::Point2d(0.0, 16.0), TextAnchor::middle, number(x));
  }
  drawing.addText({frame.left, frame.top - 8.0}, TextAnchor::start, frame.title);
  drawing.addText({frame.left + frame.width, frame.top + frame.height + 32.0}, TextAnchor::end,
                  frame.x_title);
}

}  // namespace

void addDiagram(Drawing& drawing, const Diagram& diagram) {
  const Axes axes(diagram);
  addAxes(drawing, axes);
  for (const DiagramCurve& curve : diagram.curves) {
    std::vector<cv::Point2d> points;
    points.reserve(curve.points.size());
    for (const cv::Point2d& value : curve.points)
      points.push_back(axes.at(value));
    drawing.addLine(std::move(points), curve.colour, curve.width, curve.opacity);
  }
}

void addLegendEntry(Drawing& drawing, cv::Point2d at, DrawingColour colour, const std::string& name) {
  constexpr double kLength = 30.0;
  drawing.addLine({at, at + cv::Point2d(kLength, 0.0)}, colour, 3.0);
  drawing.addText(at + cv::Point2d(kLength + 6.0, 4.0), TextAnchor::start, name);
}

}  // namespace cartvo
