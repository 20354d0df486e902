// Table, JSON and plot that compare stereo designs.
#include "tools/calibrate/plan/plan_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "common/exact_text.hpp"
#include "common/units.hpp"
#include "tools/report/drawing.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {
namespace {

// Diagrams with a logarithmic y axis.

/// A curve of a diagram.
struct DiagramCurve {
  std::vector<cv::Point2d> points;
  DrawingColour colour;
  double width = 1.0, opacity = 1.0;
};

/// A diagram in a drawing: logarithmic y axis whose full decades contain all values, linear x axis.
struct Diagram {
  std::string title, x_title;
  double x_step = 1.0;                                      ///< between grid lines
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  ///< of the frame, px
  std::vector<DiagramCurve> curves;
};

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

/// Adds a diagram. The x axis begins at 0.
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

/// Adds a legend entry: a line that starts at `at`, and its name.
void addLegendEntry(Drawing& drawing, cv::Point2d at, DrawingColour colour, const std::string& name) {
  constexpr double kLength = 30.0;
  drawing.addLine({at, at + cv::Point2d(kLength, 0.0)}, colour, 3.0);
  drawing.addText(at + cv::Point2d(kLength + 6.0, 4.0), TextAnchor::start, name);
}

}  // namespace
}  // namespace cartvo

namespace cartvo::calibrate {
namespace {

double largestDisparity(const StereoDesign& design, const PlanSettings& settings) {
  return settings.largest_disparity.value_or(vo::nearestDisparity(static_cast<int>(design.image_width)));
}

double nearestMatched(const StereoDesign& design, const PlanSettings& settings) {
  return disparityAt(design, 1.0) / largestDisparity(design, settings);
}

std::string nameOf(const StereoDesign& design) {
  return "b " + significant(design.baseline) + " m, f " + fixed(design.focal_length, 0) + " px, " +
         fixed(design.image_width, 0) + " px wide";
}

/// A property of a design as a function of the range.
using Measure = std::function<double(const StereoDesign&, double range)>;

DrawingColour colourOf(std::size_t index) {
  // Okabe and Ito's palette, which is safe for colour-blind readers, without its yellow.
  constexpr std::array<DrawingColour, 7> kColours{{{0, 114, 178},
                                                   {213, 94, 0},
                                                   {0, 158, 115},
                                                   {204, 121, 167},
                                                   {86, 180, 233},
                                                   {230, 159, 0},
                                                   {0, 0, 0}}};
  return kColours[index % kColours.size()];
}

Diagram diagramOf(const std::vector<StereoDesign>& designs, double max_range, const Measure& measure) {
  constexpr int kPoints = 200;
  Diagram diagram;
  diagram.x_title = "range (m)";
  diagram.x_step = max_range > 20.0 ? 5.0 : 1.0;
  diagram.left = 70.0;
  diagram.width = 600.0;
  diagram.height = 260.0;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    DiagramCurve curve{{}, colourOf(i), 2.0, 1.0};
    for (int point = 1; point <= kPoints; ++point) {
      const double range = max_range * point / kPoints;
      const double value = measure(designs[i], range);
      if (value > 0.0) curve.points.emplace_back(range, value);
    }
    diagram.curves.push_back(curve);
  }
  return diagram;
}

}  // namespace

std::string planTable(const std::vector<StereoDesign>& designs, const PlanSettings& settings,
                      ReportFormat format) {
  const auto row_of = [&designs](const std::string& name, const auto& text_of) {
    std::vector<std::string> row{name};
    std::transform(designs.begin(), designs.end(), std::back_inserter(row), text_of);
    return row;
  };
  using Design = const StereoDesign&;
  Table table(row_of("baseline (m)", [](Design design) { return exactText(design.baseline); }));
  table.add(row_of("focal length (px)", [](Design design) { return fixed(design.focal_length, 1); }));
  table.add(row_of("width (px)", [](Design design) { return fixed(design.image_width, 0); }));
  table.add(row_of("view (deg)",
                   [](Design design) { return fixed(kDegreesPerRadian * horizontalView(design), 1); }));
  table.add(row_of("from (m)", [&](Design design) { return significant(nearestMatched(design, settings)); }));
  table.add(row_of("to " + exactText(100.0 * settings.relative_error) + " % (m)", [&](Design design) {
    return significant(rangeOfRelativeError(design, settings.disparity_noise, settings.relative_error));
  }));
  for (const double range : settings.ranges) {
    const std::string place = " at " + exactText(range) + " m ";
    table.add(row_of("error" + place + "(m)", [&](Design design) {
      return significant(depthError(design, settings.disparity_noise, range));
    }));
    table.add(row_of("overlap" + place + "(%)",
                     [&](Design design) { return fixed(100.0 * overlapAt(design, range), 1); }));
  }
  return table.as(format);
}

nlohmann::ordered_json planJson(const std::vector<StereoDesign>& designs, const PlanSettings& settings) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const StereoDesign& design : designs) {
    nlohmann::ordered_json at = nlohmann::ordered_json::array();
    for (const double range : settings.ranges) {
      at.push_back({{"range_m", range},
                    {"disparity_px", disparityAt(design, range)},
                    {"depth_error_m", depthError(design, settings.disparity_noise, range)},
                    {"overlap", overlapAt(design, range)}});
    }
    rows.push_back(
        {{"baseline_m", design.baseline},
         {"focal_length_px", design.focal_length},
         {"image_width_px", design.image_width},
         {"horizontal_view_deg", kDegreesPerRadian * horizontalView(design)},
         {"largest_disparity_px", largestDisparity(design, settings)},
         {"nearest_m", nearestMatched(design, settings)},
         {"good_to_m", rangeOfRelativeError(design, settings.disparity_noise, settings.relative_error)},
         {"ranges", at}});
  }
  return {{"disparity_noise_px", settings.disparity_noise},
          {"good_relative_error", settings.relative_error},
          {"designs", rows}};
}

Drawing planPlot(const std::vector<StereoDesign>& designs, const PlanSettings& settings) {
  constexpr double kLegendTop = 24.0, kLegendLine = 20.0, kDiagramPitch = 340.0;  // px
  const double max_range = *std::max_element(settings.ranges.begin(), settings.ranges.end());
  const double top = kLegendTop + kLegendLine * static_cast<double>(designs.size()) + 26.0;
  Drawing drawing(700, static_cast<int>(top + 2.0 * kDiagramPitch));
  for (std::size_t i = 0; i < designs.size(); ++i) {
    addLegendEntry(drawing, {70.0, kLegendTop + kLegendLine * static_cast<double>(i)}, colourOf(i),
                   nameOf(designs[i]));
  }
  Diagram error = diagramOf(designs, max_range, [&](const StereoDesign& design, double range) {
    return depthError(design, settings.disparity_noise, range);
  });
  error.title = "depth error (m) with disparity noise of " + exactText(settings.disparity_noise) + " px";
  error.top = top;
  Diagram overlap = diagramOf(designs, max_range, [](const StereoDesign& design, double range) {
    return 100.0 * (1.0 - overlapAt(design, range));
  });
  overlap.title = "part of the left camera's view outside that of the right one (%)";
  overlap.top = top + kDiagramPitch;
  addDiagram(drawing, error);
  addDiagram(drawing, overlap);
  return drawing;
}

}  // namespace cartvo::calibrate
