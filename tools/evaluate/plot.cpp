// Plots an estimate and its truth.

#include "tools/evaluate/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/ground_paths.hpp"
#include "tools/report/axis.hpp"

namespace cartvo {
namespace {

const cv::Size kPicture(1400, 1000);
const cv::Rect kMapFrame(90, 70, 1270, 560);
const cv::Rect kErrorFrame(90, 720, 1270, 200);

constexpr DrawingColour kInk{45, 50, 60}, kGrid{224, 228, 232};
constexpr DrawingColour kTruthColour{100, 110, 120}, kEstimateColour{20, 90, 190}, kEndColour{200, 40, 40};

using Points = std::vector<cv::Point2d>;

/// Maps values to pixels inside a frame of the drawing.
struct Axes {
  cv::Rect frame;
  double x_low, x_high, y_low, y_high;

  cv::Point2d operator()(const cv::Point2d& value) const {
    return {frame.x + (value.x - x_low) / (x_high - x_low) * frame.width,
            frame.y + frame.height - (value.y - y_low) / (y_high - y_low) * frame.height};
  }
  Points operator()(const Points& values) const {
    Points pixels;
    for (const cv::Point2d& value : values)
      pixels.push_back((*this)(value));
    return pixels;
  }
};

void drawGrid(Drawing& drawing, const Axes& axes, double x_step, double y_step) {
  for (const double x : multiplesOf(x_step, axes.x_low, axes.x_high)) {
    drawing.addLine({axes({x, axes.y_low}), axes({x, axes.y_high})}, kGrid, 1);
    drawing.addText(axes({x, axes.y_low}) + cv::Point2d(0, 20), TextAnchor::middle, tickLabel(x, x_step),
                    kInk);
  }
  for (const double y : multiplesOf(y_step, axes.y_low, axes.y_high)) {
    drawing.addLine({axes({axes.x_low, y}), axes({axes.x_high, y})}, kGrid, 1);
    drawing.addText(axes({axes.x_low, y}) + cv::Point2d(-8, 5), TextAnchor::end, tickLabel(y, y_step), kInk);
  }
  const cv::Point2d low = axes.frame.tl(), high = axes.frame.br();
  drawing.addLine({low, {high.x, low.y}, high, {low.x, high.y}, low}, kInk, 1);
}

/// Axes with equal scale that contain all points with a margin.
Axes equalAxes(const GroundPaths& paths) {
  cv::Point2d low = paths.truth.front(), high = low;
  for (const Points* points : {&paths.truth, &paths.estimate}) {
    for (const cv::Point2d& point : *points) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  }
  constexpr double kMargin = 1.15;     // factor on the extent
  constexpr double kMinExtent = 0.01;  // m, for a standstill
  const double width = std::max(high.x - low.x, kMinExtent), height = std::max(high.y - low.y, kMinExtent);
  const double metres_per_pixel = kMargin * std::max(width / kMapFrame.width, height / kMapFrame.height);
  const cv::Point2d centre = (low + high) / 2.0;
  const double half_width = metres_per_pixel * kMapFrame.width / 2.0;
  const double half_height = metres_per_pixel * kMapFrame.height / 2.0;
  return {kMapFrame, centre.x - half_width, centre.x + half_width, centre.y - half_height,
          centre.y + half_height};
}

void drawScaleBar(Drawing& drawing, const Axes& axes) {
  const double length = roundStep(axes.x_high - axes.x_low, 8);
  const cv::Point2d right(axes.frame.br().x,
                          axes.frame.br().y + 38.0);  // outside the frame, so that it covers no path
  const double pixels = length / (axes.x_high - axes.x_low) * axes.frame.width;
  const cv::Point2d left = right - cv::Point2d(pixels, 0.0);
  drawing.addLine({left, right}, kInk, 3);
  for (const cv::Point2d& end : {left, right})
    drawing.addLine({end - cv::Point2d(0, 5), end + cv::Point2d(0, 5)}, kInk, 2);
  drawing.addText(left - cv::Point2d(10, -5), TextAnchor::end, tickLabel(length, length) + " m", kInk);
}

void drawLegend(Drawing& drawing) {
  double x = kMapFrame.x;
  constexpr double kY = 42.0;
  const auto line_entry = [&](const char* name, DrawingColour colour, double width) {
    drawing.addLine({{x, kY}, {x + 36, kY}}, colour, width);
    drawing.addText({x + 46, kY + 5}, TextAnchor::start, name, kInk);
    x += 150;
  };
  const auto dot_entry = [&](const char* name, DrawingColour colour, double line_width) {
    drawing.addCircle({x + 8, kY}, 6, colour, line_width);
    drawing.addText({x + 24, kY + 5}, TextAnchor::start, name, kInk);
    x += 110;
  };
  line_entry("truth", kTruthColour, 5);
  line_entry("estimate", kEstimateColour, 2);
  dot_entry("start", kInk, 2);
  dot_entry("end", kEndColour, 0);
}

void drawMap(Drawing& drawing, const GroundPaths& paths) {
  const Axes axes = equalAxes(paths);
  const double step = roundStep(axes.x_high - axes.x_low, 10);
  drawGrid(drawing, axes, step, step);
  drawing.addLine(axes(paths.truth), kTruthColour, 5);
  drawing.addLine(axes(paths.estimate), kEstimateColour, 2);
  drawing.addCircle(axes(paths.truth.front()), 7, kInk, 2);
  drawing.addCircle(axes(paths.truth.back()), 6, kTruthColour, 0);
  drawing.addCircle(axes(paths.estimate.back()), 5, kEndColour, 0);
  drawScaleBar(drawing, axes);
  drawing.addText({kMapFrame.x + kMapFrame.width / 2.0, kMapFrame.br().y + 42.0}, TextAnchor::middle,
                  paths.horizontal, kInk);
  drawing.addText({kMapFrame.x + 8.0, kMapFrame.y + 20.0}, TextAnchor::start, paths.vertical, kInk);
}

void drawError(Drawing& drawing, const AssociatedTrajectories& associated) {
  const std::vector<double> distances = distancesAlong(associated.truth);
  const Trajectory moved = startingAt(associated.truth.front().pose, associated.estimate);
  Points errors;
  double largest = 1e-3;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double error = (moved[i].pose.translation() - associated.truth[i].pose.translation()).norm();
    errors.emplace_back(distances[i], error);
    largest = std::max(largest, error);
  }
  const Axes axes{kErrorFrame, 0.0, std::max(distances.back(), 0.01), 0.0, 1.1 * largest};
  drawGrid(drawing, axes, roundStep(axes.x_high, 10), roundStep(axes.y_high, 4));
  drawing.addLine(axes(errors), kEstimateColour, 2);
  drawing.addText({kErrorFrame.x + 8.0, kErrorFrame.y - 10.0}, TextAnchor::start,
                  "position error (m), starts coincide", kInk);
  drawing.addText({kErrorFrame.x + kErrorFrame.width / 2.0, kErrorFrame.br().y + 42.0}, TextAnchor::middle,
                  "distance driven (m)", kInk);
}

std::string headline(const AssociatedTrajectories& associated) {
  const Evaluation evaluation = evaluate(associated);
  char text[96];
  if (evaluation.final_drift_fraction) {
    std::snprintf(text, sizeof text, "%.1f m driven, final drift %.3f m (%.3f %%)", evaluation.path_length,
                  evaluation.final_drift, 100.0 * *evaluation.final_drift_fraction);
  } else {
    std::snprintf(text, sizeof text, "%.2f m driven, final drift %.3f m", evaluation.path_length,
                  evaluation.final_drift);
  }
  return text;
}

}  // namespace

Drawing plotTrajectories(const AssociatedTrajectories& associated, TopView view) {
  Drawing drawing(kPicture.width, kPicture.height);
  drawLegend(drawing);
  drawing.addText({static_cast<double>(kMapFrame.br().x), 47.0}, TextAnchor::end, headline(associated), kInk);
  drawMap(drawing, groundPaths(associated, view));
  drawError(drawing, associated);
  return drawing;
}

}  // namespace cartvo
