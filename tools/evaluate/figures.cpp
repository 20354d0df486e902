// Figures of paths, errors and segments.
#include "tools/evaluate/figures.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/units.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

/// Errors of one pose when the starts coincide.
struct PoseError {
  double distance = 0.0;     ///< true distance from the start along the path, m
  double seconds = 0.0;      ///< as secondsOf()
  double translation = 0.0;  ///< m
  double rotation_deg = 0.0;
};

/// Time of each compared pose, s since the first message, or since the first pose if there are no messages;
/// empty if the files have no times and there are no messages.
std::vector<double> secondsOf(const ReportInput& input) {
  const Trajectory& estimate = input.associated.estimate;
  const bool has_times = input.associated.method == AssociationMethod::time;
  if (!has_times && input.messages.size() != estimate.size()) return {};
  const std::int64_t start_ns =
      input.messages.empty() ? estimate.front().time_ns : input.messages.front().time_ns;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::int64_t time_ns = has_times ? estimate[i].time_ns : input.messages[i].time_ns;
    seconds.push_back(1e-9 * static_cast<double>(time_ns - start_ns));
  }
  return seconds;
}

std::vector<PoseError> poseErrors(const ReportInput& input) {
  const AssociatedTrajectories& associated = input.associated;
  const std::vector<double> distances = distancesAlong(associated.truth), seconds = secondsOf(input);
  const Trajectory moved = startingAt(associated.truth.front().pose, associated.estimate);
  std::vector<PoseError> errors;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Eigen::Isometry3d error = associated.truth[i].pose.inverse() * moved[i].pose;
    errors.push_back({distances[i], seconds.empty() ? 0.0 : seconds[i], error.translation().norm(),
                      kDegreesPerRadian * Eigen::AngleAxisd(error.linear()).angle()});
  }
  return errors;
}

/// Positions of the estimate at messages that are not valid, except the first message.
std::vector<cv::Point2d> invalidPlaces(const ReportInput& input, const GroundPaths& paths) {
  const bool by_time = input.associated.method == AssociationMethod::time;
  std::set<std::int64_t> invalid;  // microseconds, as messages have them, or rows
  for (std::size_t i = 1; i < input.messages.size(); ++i) {
    if (!input.messages[i].valid)
      invalid.insert(by_time ? input.messages[i].time_ns / 1000 : static_cast<std::int64_t>(i));
  }
  std::vector<cv::Point2d> places;
  for (std::size_t i = 0; i < paths.estimate.size(); ++i) {
    const std::int64_t key =
        by_time ? input.associated.estimate[i].time_ns / 1000 : static_cast<std::int64_t>(i);
    if (invalid.contains(key)) places.push_back(paths.estimate[i]);
  }
  return places;
}

/// Height of a plot with equal scale that leaves little room beside the paths, px.
int heightFor(const GroundPaths& paths) {
  constexpr double kPlotWidth = 524.0, kMinHeight = 180.0, kMaxHeight = 460.0, kMargin = 1.25;
  cv::Point2d low = paths.truth.front(), high = low;
  for (const std::vector<cv::Point2d>* points : {&paths.truth, &paths.estimate}) {
    for (const cv::Point2d& point : *points) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  }
  const double width = std::max(high.x - low.x, 1e-3);
  return static_cast<int>(
      std::clamp(kMargin * kPlotWidth * (high.y - low.y) / width, kMinHeight, kMaxHeight));
}

Figure pathFigure(const ReportInput& input) {
  const GroundPaths paths = groundPaths(input.associated, input.view);
  Figure figure;
  figure.name = "trajectory";
  figure.chart.title = "Path from above, starts coincide";
  figure.chart.x_title = paths.horizontal;
  figure.chart.has_equal_scale = true;
  ChartPanel panel;
  panel.y_title = paths.vertical;
  panel.height = heightFor(paths);
  panel.series = {{"truth", kChartInk, paths.truth, SeriesStyle::dashed},
                  {"estimate", kChartBlue, paths.estimate},
                  {"start", kChartGreen, {paths.truth.front()}, SeriesStyle::dots},
                  {"end of truth", kChartInk, {paths.truth.back()}, SeriesStyle::dots},
                  {"end of estimate", kChartBlue, {paths.estimate.back()}, SeriesStyle::dots}};
  if (std::vector<cv::Point2d> places = invalidPlaces(input, paths); !places.empty())
    panel.series.push_back({"not valid", kChartRed, std::move(places), SeriesStyle::dots});
  figure.chart.panels = {std::move(panel)};
  figure.caption = "Both paths on the ground plane of the truth's first pose.";
  figure.columns = {"truth, " + paths.horizontal, "truth, " + paths.vertical, "estimate, " + paths.horizontal,
                    "estimate, " + paths.vertical};
  for (const std::size_t i : spreadIndices(paths.truth.size())) {
    figure.rows.push_back({fixed(paths.truth[i].x, 2), fixed(paths.truth[i].y, 2),
                           fixed(paths.estimate[i].x, 2), fixed(paths.estimate[i].y, 2)});
  }
  return figure;
}

/// Errors over `axis`, a member of PoseError.
Figure errorFigure(const std::vector<PoseError>& errors, double PoseError::*axis,
                   const std::string& x_title) {
  const auto panel_of = [&](double PoseError::*value, const std::string& title) {
    ChartSeries series{"", kChartBlue, {}};
    double largest = 0.0;
    for (const PoseError& error : errors) {
      series.points.emplace_back(error.*axis, error.*value);
      largest = std::max(largest, error.*value);
    }
    ChartPanel panel;
    panel.y_title =
        title + ", at most " + significant(largest) + ", at the end " + significant(errors.back().*value);
    panel.series = {std::move(series)};
    panel.contains_zero = true;
    panel.height = 150;
    return panel;
  };
  Figure figure;
  figure.chart.x_title = x_title;
  figure.chart.panels = {panel_of(&PoseError::translation, "position (m)"),
                         panel_of(&PoseError::rotation_deg, "rotation (deg)")};
  figure.columns = {x_title, "position (m)", "rotation (deg)"};
  for (const std::size_t i : spreadIndices(errors.size())) {
    figure.rows.push_back(
        {fixed(errors[i].*axis, 2), fixed(errors[i].translation, 3), fixed(errors[i].rotation_deg, 3)});
  }
  return figure;
}

/// Segments of all lengths, the short ones first.
std::vector<SegmentErrors> allSegments(const Evaluation& evaluation) {
  std::vector<SegmentErrors> segments = evaluation.short_segments.each;
  segments.insert(segments.end(), evaluation.long_segments.each.begin(), evaluation.long_segments.each.end());
  return segments;
}

Figure segmentFigure(const std::vector<SegmentErrors>& segments) {
  const auto panel_of = [&](const std::string& title, const auto& value) {
    ChartSeries line{"", kChartBlue, {}}, dots{"", kChartBlue, {}, SeriesStyle::dots};
    for (const SegmentErrors& errors : segments)
      line.points.emplace_back(errors.length, value(errors));
    dots.points = line.points;
    ChartPanel panel;
    panel.y_title = title;
    panel.series = {std::move(line), std::move(dots)};
    panel.contains_zero = true;
    panel.height = 140;
    return panel;
  };
  const auto percent = [](const SegmentErrors& errors) { return 100.0 * errors.translation; };
  const auto degrees = [](const SegmentErrors& errors) { return kDegreesPerRadian * errors.rotation; };
  Figure figure;
  figure.name = "segments";
  figure.chart.title = "Error of segments by their length";
  figure.chart.x_title = "length of the segments (m)";
  figure.chart.panels = {panel_of("translation (% of the length)", percent),
                         panel_of("rotation (deg/m)", degrees)};
  figure.caption =
      "Error of the motion between two poses that are a length apart on the true path, divided by that "
      "length. "
      "100 to 800 m as in KITTI's devkit, starting at each tenth pose; 5 to 40 m starting at each pose.";
  figure.columns = {"length (m)", "segments", "translation (%)", "rotation (deg/m)"};
  for (const SegmentErrors& errors : segments) {
    figure.rows.push_back({fixed(errors.length, 0), std::to_string(errors.count), fixed(percent(errors), 3),
                           fixed(degrees(errors), 5)});
  }
  return figure;
}

}  // namespace

std::vector<std::size_t> spreadIndices(std::size_t count) {
  constexpr std::size_t kMaxRows = 30;
  std::vector<std::size_t> indices;
  const std::size_t rows = std::min(count, kMaxRows);
  for (std::size_t i = 0; i < rows; ++i)
    indices.push_back(rows == 1 ? 0 : i * (count - 1) / (rows - 1));
  return indices;
}

std::vector<Figure> evaluationFigures(const ReportInput& input) {
  std::vector<Figure> figures{pathFigure(input)};
  const std::vector<PoseError> errors = poseErrors(input);
  Figure over_distance = errorFigure(errors, &PoseError::distance, "distance driven (m)");
  over_distance.name = "error-over-distance";
  over_distance.chart.title = "Error of the pose over distance, starts coincide";
  over_distance.caption = "Distance and angle between the estimated and the true pose.";
  figures.push_back(std::move(over_distance));
  if (!secondsOf(input).empty()) {
    Figure over_time = errorFigure(errors, &PoseError::seconds, "time (s)");
    over_time.name = "error-over-time";
    over_time.chart.title = "Error of the pose over time, starts coincide";
    over_time.caption = "The same errors over time; a bar below shows when messages were not valid.";
    over_time.chart.marked = invalidSpans(input.messages);
    if (!input.messages.empty()) {
      over_time.chart.marked_name = "not valid";
      over_time.chart.unmarked_name = "valid";
    }
    figures.push_back(std::move(over_time));
  }
  if (const std::vector<SegmentErrors> segments = allSegments(input.evaluation); !segments.empty())
    figures.push_back(segmentFigure(segments));
  if (input.messages.empty()) return figures;
  for (Figure& figure : motionFigures(input.messages))
    figures.push_back(std::move(figure));
  for (Figure& figure : boundFigures(judgedMessages(input.messages), input.limits))
    figures.push_back(std::move(figure));
  return figures;
}

}  // namespace cartvo
