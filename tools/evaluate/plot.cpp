// Plots an estimate and its truth.

#include "tools/evaluate/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tools/evaluate/evaluation.hpp"

namespace cartvo {
namespace {

// The plot is drawn at twice the size and reduced, which smooths lines and OpenCV's letters.
constexpr int kOversampling = 2;
const cv::Size kPicture(1400, 1000);
const cv::Rect kMapFrame(90, 70, 1270, 560);
const cv::Rect kErrorFrame(90, 720, 1270, 200);

const cv::Scalar kPaper(255, 255, 255), kInk(60, 50, 45), kGrid(232, 228, 224);
const cv::Scalar kTruthColour(120, 110, 100), kEstimateColour(190, 90, 20), kEndColour(40, 40, 200);

using Points = std::vector<cv::Point2d>;

/// Step of 1, 2 or 5 times a power of ten that divides `range` into about `parts` parts.
double roundStep(double range, int parts) {
  const double rough = std::max(range, 1e-9) / parts;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= rough) return factor * decade;
  }
  return 10.0 * decade;
}

std::string label(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, std::abs(value) < 1e-9 ? 0.0 : value);
  return text;
}

/// Position of a text's reference point.
enum class Anchor : std::uint8_t { left, centre, right };

/// White image; coordinates are pixels of the final picture.
class Sheet {
 public:
  Sheet() : image_(kPicture * kOversampling, CV_8UC3, kPaper) {}

  void line(const Points& points, const cv::Scalar& colour, double width) {
    std::vector<cv::Point> scaled;
    for (const cv::Point2d& point : points)
      scaled.push_back(fixed(point));
    cv::polylines(image_, scaled, false, colour, static_cast<int>(std::lround(width * kOversampling)),
                  cv::LINE_AA, kShift);
  }
  void dot(const cv::Point2d& centre, double radius, const cv::Scalar& colour, int thickness) {
    cv::circle(image_, fixed(centre), static_cast<int>(radius * kOversampling * (1 << kShift)), colour,
               thickness < 0 ? cv::FILLED : thickness * kOversampling, cv::LINE_AA, kShift);
  }
  void frame(const cv::Rect& rectangle) {
    cv::rectangle(image_, cv::Rect(rectangle.tl() * kOversampling, rectangle.size() * kOversampling), kInk,
                  kOversampling, cv::LINE_AA);
  }
  void text(const std::string& letters, cv::Point2d at, Anchor anchor, const cv::Scalar& colour) {
    constexpr double kSize = 0.5 * kOversampling;
    const int width = cv::getTextSize(letters, cv::FONT_HERSHEY_SIMPLEX, kSize, kOversampling, nullptr).width;
    cv::Point origin(static_cast<int>(at.x * kOversampling), static_cast<int>(at.y * kOversampling));
    if (anchor != Anchor::left) origin.x -= anchor == Anchor::right ? width : width / 2;
    cv::putText(image_, letters, origin, cv::FONT_HERSHEY_SIMPLEX, kSize, colour, kOversampling, cv::LINE_AA);
  }
  cv::Mat finished() const {
    cv::Mat small;
    cv::resize(image_, small, kPicture, 0, 0, cv::INTER_AREA);
    return small;
  }

 private:
  static constexpr int kShift = 4;
  static cv::Point fixed(const cv::Point2d& point) {
    const double scale = kOversampling * (1 << kShift);
    return {static_cast<int>(std::lround(point.x * scale)), static_cast<int>(std::lround(point.y * scale))};
  }

  cv::Mat image_;
};

/// Maps values to pixels inside a frame of the sheet.
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

/// Multiples of `step` from `low` to `high`.
std::vector<double> multiples(double step, double low, double high) {
  std::vector<double> values;
  for (auto i = std::llround(std::ceil(low / step)); static_cast<double>(i) * step <= high; ++i) {
    values.push_back(static_cast<double>(i) * step);
  }
  return values;
}

void drawGrid(Sheet& sheet, const Axes& axes, double x_step, double y_step) {
  for (const double x : multiples(x_step, axes.x_low, axes.x_high)) {
    sheet.line({axes({x, axes.y_low}), axes({x, axes.y_high})}, kGrid, 1);
    sheet.text(label(x, x_step), axes({x, axes.y_low}) + cv::Point2d(0, 20), Anchor::centre, kInk);
  }
  for (const double y : multiples(y_step, axes.y_low, axes.y_high)) {
    sheet.line({axes({axes.x_low, y}), axes({axes.x_high, y})}, kGrid, 1);
    sheet.text(label(y, y_step), axes({axes.x_low, y}) + cv::Point2d(-8, 5), Anchor::right, kInk);
  }
  sheet.frame(axes.frame);
}

/// Both paths on the ground plane, and the names of the axes.
struct GroundPaths {
  Points truth, estimate;
  std::string horizontal, vertical;
};

/// Forward is up, unless the path is longer forward than sideways: then forward is to the right.
GroundPaths groundPaths(const AssociatedTrajectories& associated, TopView view) {
  const Eigen::Isometry3d origin = associated.truth.front().pose.inverse();
  const bool is_camera = view == TopView::camera_axes;
  const auto forward_and_left = [&](const StampedPose& stamped) {
    const Eigen::Vector3d position = origin * stamped.pose.translation();
    return is_camera ? cv::Point2d(position.z(), -position.x()) : cv::Point2d(position.x(), position.y());
  };
  GroundPaths paths;
  for (const StampedPose& stamped : associated.truth)
    paths.truth.push_back(forward_and_left(stamped));
  for (const StampedPose& stamped : startingAt(associated.truth.front().pose, associated.estimate)) {
    paths.estimate.push_back(forward_and_left(stamped));
  }
  cv::Point2d low = paths.truth.front(), high = low;
  for (const cv::Point2d& point : paths.truth) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  paths.horizontal = "forward (m)";
  paths.vertical = "left (m)";
  if (high.x - low.x < high.y - low.y) {
    for (Points* points : {&paths.truth, &paths.estimate}) {
      for (cv::Point2d& point : *points)
        point = {-point.y, point.x};
    }
    paths.horizontal = "right (m)";
    paths.vertical = "forward (m)";
  }
  return paths;
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

void drawScaleBar(Sheet& sheet, const Axes& axes) {
  const double length = roundStep(axes.x_high - axes.x_low, 8);
  const cv::Point2d right(axes.frame.br().x,
                          axes.frame.br().y + 38.0);  // outside the frame, so that it covers no path
  const double pixels = length / (axes.x_high - axes.x_low) * axes.frame.width;
  const cv::Point2d left = right - cv::Point2d(pixels, 0.0);
  sheet.line({left, right}, kInk, 3);
  for (const cv::Point2d& end : {left, right})
    sheet.line({end - cv::Point2d(0, 5), end + cv::Point2d(0, 5)}, kInk, 2);
  sheet.text(label(length, length) + " m", left - cv::Point2d(10, -5), Anchor::right, kInk);
}

void drawLegend(Sheet& sheet) {
  double x = kMapFrame.x;
  constexpr double kY = 42.0;
  const auto line_entry = [&](const char* name, const cv::Scalar& colour, double width) {
    sheet.line({{x, kY}, {x + 36, kY}}, colour, width);
    sheet.text(name, {x + 46, kY + 5}, Anchor::left, kInk);
    x += 150;
  };
  const auto dot_entry = [&](const char* name, const cv::Scalar& colour, int thickness) {
    sheet.dot({x + 8, kY}, 6, colour, thickness);
    sheet.text(name, {x + 24, kY + 5}, Anchor::left, kInk);
    x += 110;
  };
  line_entry("truth", kTruthColour, 5);
  line_entry("estimate", kEstimateColour, 2);
  dot_entry("start", kInk, 2);
  dot_entry("end", kEndColour, -1);
}

void drawMap(Sheet& sheet, const GroundPaths& paths) {
  const Axes axes = equalAxes(paths);
  const double step = roundStep(axes.x_high - axes.x_low, 10);
  drawGrid(sheet, axes, step, step);
  sheet.line(axes(paths.truth), kTruthColour, 5);
  sheet.line(axes(paths.estimate), kEstimateColour, 2);
  sheet.dot(axes(paths.truth.front()), 7, kInk, 2);
  sheet.dot(axes(paths.truth.back()), 6, kTruthColour, -1);
  sheet.dot(axes(paths.estimate.back()), 5, kEndColour, -1);
  drawScaleBar(sheet, axes);
  sheet.text(paths.horizontal, {kMapFrame.x + kMapFrame.width / 2.0, kMapFrame.br().y + 42.0}, Anchor::centre,
             kInk);
  sheet.text(paths.vertical, {kMapFrame.x + 8.0, kMapFrame.y + 20.0}, Anchor::left, kInk);
}

void drawError(Sheet& sheet, const AssociatedTrajectories& associated) {
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
  drawGrid(sheet, axes, roundStep(axes.x_high, 10), roundStep(axes.y_high, 4));
  sheet.line(axes(errors), kEstimateColour, 2);
  sheet.text("position error (m), starts coincide", {kErrorFrame.x + 8.0, kErrorFrame.y - 10.0}, Anchor::left,
             kInk);
  sheet.text("distance driven (m)", {kErrorFrame.x + kErrorFrame.width / 2.0, kErrorFrame.br().y + 42.0},
             Anchor::centre, kInk);
}

std::string headline(const AssociatedTrajectories& associated) {
  const Evaluation evaluation = evaluate(associated);
  char text[96];
  if (evaluation.final_drift_fraction) {
    std::snprintf(text, sizeof text, "%.1f m driven, final drift %.2f m (%.2f %%)", evaluation.path_length,
                  evaluation.final_drift, 100.0 * *evaluation.final_drift_fraction);
  } else {
    std::snprintf(text, sizeof text, "%.2f m driven, final drift %.3f m", evaluation.path_length,
                  evaluation.final_drift);
  }
  return text;
}

}  // namespace

cv::Mat plotTrajectories(const AssociatedTrajectories& associated, TopView view) {
  Sheet sheet;
  drawLegend(sheet);
  sheet.text(headline(associated), {static_cast<double>(kMapFrame.br().x), 47.0}, Anchor::right, kInk);
  drawMap(sheet, groundPaths(associated, view));
  drawError(sheet, associated);
  return sheet.finished();
}

}  // namespace cartvo
