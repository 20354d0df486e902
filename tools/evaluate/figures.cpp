// Figures of paths, errors and segments.
#include "tools/evaluate/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "common/units.hpp"
#include "tools/evaluate/alignment.hpp"
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
  const Trajectory moved = placedEstimate(associated);
  std::vector<PoseError> errors;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Eigen::Isometry3d error = associated.truth[i].pose.inverse() * moved[i].pose;
    errors.push_back({distances[i], seconds.empty() ? 0.0 : seconds[i], error.translation().norm(),
                      kDegreesPerRadian * Eigen::AngleAxisd(error.linear()).angle()});
  }
  return errors;
}

/// Positions of the estimate at messages that are not valid, except the first message.
std::vector<cv::Point2d> invalidPlaces(const ReportInput& input, const std::vector<cv::Point2d>& path) {
  const bool by_time = input.associated.method == AssociationMethod::time;
  std::set<std::int64_t> invalid;  // microseconds, as messages have them, or rows
  for (std::size_t i = 1; i < input.messages.size(); ++i) {
    if (!input.messages[i].valid)
      invalid.insert(by_time ? input.messages[i].time_ns / 1000 : static_cast<std::int64_t>(i));
  }
  std::vector<cv::Point2d> places;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::int64_t key =
        by_time ? input.associated.estimate[i].time_ns / 1000 : static_cast<std::int64_t>(i);
    if (invalid.contains(key)) places.push_back(path[i]);
  }
  return places;
}

/// The colour of an estimate (M. Okabe, K. Ito, 2008).
DrawingColour colourOf(std::size_t estimate) {
  constexpr std::array<DrawingColour, 6> kColours{
      {kChartBlue, {230, 159, 0}, kChartGreen, {204, 121, 167}, {86, 180, 233}, {166, 118, 29}}};
  return kColours.at(estimate % kColours.size());
}

/// The name of an estimate in a legend, where `alone` stands for the only one.
std::string nameOf(const std::vector<ReportInput>& inputs, std::size_t index, const std::string& alone) {
  return inputs.size() == 1 ? alone : inputs[index].estimate;
}

/// Adds a row to a figure's numbers; of several estimates it begins with the name.
void addRow(const std::vector<ReportInput>& inputs, std::size_t index, std::vector<std::string> cells,
            Figure& figure) {
  if (inputs.size() > 1) cells.insert(cells.begin(), inputs[index].estimate);
  figure.rows.push_back(std::move(cells));
}

std::vector<std::string> columnsOf(const std::vector<ReportInput>& inputs, std::vector<std::string> columns) {
  if (inputs.size() > 1) columns.insert(columns.begin(), "estimate");
  return columns;
}

/// Height of a plot with equal scale that leaves little room beside the paths, px.
int heightFor(const GroundPaths& paths) {
  constexpr double kPlotWidth = 524.0, kMinHeight = 180.0, kMaxHeight = 460.0, kMargin = 1.25;
  cv::Point2d low = paths.truth.front(), high = low;
  const auto include = [&](const std::vector<cv::Point2d>& points) {
    for (const cv::Point2d& point : points) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  };
  include(paths.truth);
  std::for_each(paths.estimates.begin(), paths.estimates.end(), include);
  const double width = std::max(high.x - low.x, 1e-3);
  return static_cast<int>(
      std::clamp(kMargin * kPlotWidth * (high.y - low.y) / width, kMinHeight, kMaxHeight));
}

Figure pathFigure(const std::vector<ReportInput>& inputs) {
  std::vector<const AssociatedTrajectories*> associated;
  for (const ReportInput& input : inputs)
    associated.push_back(&input.associated);
  const GroundPaths paths = groundPaths(associated, inputs.front().view);
  Figure figure;
  figure.name = "trajectory";
  figure.chart.title = std::string("Path from above, ") + placementName(*associated.front());
  figure.chart.x_title = paths.horizontal;
  figure.chart.has_equal_scale = true;
  ChartPanel panel;
  panel.y_title = paths.vertical;
  panel.height = heightFor(paths);
  panel.series = {{"truth", kChartInk, paths.truth, SeriesStyle::dashed}};
  for (std::size_t i = 0; i < inputs.size(); ++i)
    panel.series.push_back({nameOf(inputs, i, "estimate"), colourOf(i), paths.estimates[i]});
  panel.series.push_back({"start", kChartGreen, {paths.truth.front()}, SeriesStyle::dots});
  panel.series.push_back({"end of truth", kChartInk, {paths.truth.back()}, SeriesStyle::dots});
  figure.columns = columnsOf(
      inputs, {"estimate, " + paths.horizontal, "estimate, " + paths.vertical, "error of position (m)"});
  std::vector<cv::Point2d> invalid;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::vector<cv::Point2d>& path = paths.estimates[i];
    panel.series.push_back(
        {inputs.size() == 1 ? "end of estimate" : "", colourOf(i), {path.back()}, SeriesStyle::dots});
    const std::vector<cv::Point2d> places = invalidPlaces(inputs[i], path);
    invalid.insert(invalid.end(), places.begin(), places.end());
    const std::vector<PoseError> errors = poseErrors(inputs[i]);
    for (const std::size_t row : spreadIndices(path.size()))
      addRow(inputs, i, {fixed(path[row].x, 2), fixed(path[row].y, 2), fixed(errors[row].translation, 3)},
             figure);
  }
  if (!invalid.empty())
    panel.series.push_back({"not valid", kChartRed, std::move(invalid), SeriesStyle::dots});
  figure.chart.panels = {std::move(panel)};
  figure.caption = "All paths on the ground plane of the truth's first pose.";
  return figure;
}

/// Errors over `axis`, a member of PoseError.
Figure errorFigure(const std::vector<ReportInput>& inputs, double PoseError::*axis,
                   const std::string& x_title) {
  std::vector<std::vector<PoseError>> errors;
  for (const ReportInput& input : inputs)
    errors.push_back(poseErrors(input));
  const auto panel_of = [&](double PoseError::*value, const std::string& title) {
    ChartPanel panel;
    double largest = 0.0;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      ChartSeries series{nameOf(inputs, i, ""), colourOf(i), {}};
      for (const PoseError& error : errors[i]) {
        series.points.emplace_back(error.*axis, error.*value);
        largest = std::max(largest, error.*value);
      }
      panel.series.push_back(std::move(series));
    }
    panel.y_title = title + ", at most " + significant(largest);
    if (inputs.size() == 1) panel.y_title += ", at the end " + significant(errors.front().back().*value);
    panel.contains_zero = true;
    panel.height = 150;
    return panel;
  };
  Figure figure;
  figure.chart.x_title = x_title;
  figure.chart.panels = {panel_of(&PoseError::translation, "position (m)"),
                         panel_of(&PoseError::rotation_deg, "rotation (deg)")};
  figure.columns = columnsOf(inputs, {x_title, "position (m)", "rotation (deg)"});
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (const std::size_t row : spreadIndices(errors[i].size())) {
      const PoseError& error = errors[i][row];
      addRow(inputs, i, {fixed(error.*axis, 2), fixed(error.translation, 3), fixed(error.rotation_deg, 3)},
             figure);
    }
  }
  return figure;
}

/// Segments of all lengths, the short ones first.
std::vector<SegmentErrors> allSegments(const Evaluation& evaluation) {
  std::vector<SegmentErrors> segments = evaluation.short_segments.each;
  segments.insert(segments.end(), evaluation.long_segments.each.begin(), evaluation.long_segments.each.end());
  return segments;
}

Figure segmentFigure(const std::vector<ReportInput>& inputs) {
  const auto panel_of = [&](const std::string& title, const auto& value) {
    ChartPanel panel;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      ChartSeries line{nameOf(inputs, i, ""), colourOf(i), {}}, dots{"", colourOf(i), {}, SeriesStyle::dots};
      for (const SegmentErrors& errors : allSegments(inputs[i].evaluation))
        line.points.emplace_back(errors.length, value(errors));
      dots.points = line.points;
      panel.series.push_back(std::move(line));
      panel.series.push_back(std::move(dots));
    }
    panel.y_title = title;
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
  figure.columns = columnsOf(inputs, {"length (m)", "segments", "translation (%)", "rotation (deg/m)"});
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (const SegmentErrors& errors : allSegments(inputs[i].evaluation))
      addRow(inputs, i,
             {fixed(errors.length, 0), std::to_string(errors.count), fixed(percent(errors), 3),
              fixed(degrees(errors), 5)},
             figure);
  }
  return figure;
}

Figure distanceFigure(const std::vector<ReportInput>& inputs) {
  Figure figure = errorFigure(inputs, &PoseError::distance, "distance driven (m)");
  figure.name = "error-over-distance";
  figure.chart.title =
      std::string("Error of the pose over distance, ") + placementName(inputs.front().associated);
  figure.caption = "Distance and angle between the estimated and the true pose.";
  return figure;
}

Figure timeFigure(const std::vector<ReportInput>& inputs) {
  Figure figure = errorFigure(inputs, &PoseError::seconds, "time (s)");
  figure.name = "error-over-time";
  figure.chart.title =
      std::string("Error of the pose over time, ") + placementName(inputs.front().associated);
  figure.caption = "The same errors over time.";
  if (inputs.size() > 1 || inputs.front().messages.empty()) return figure;
  figure.caption = "The same errors over time; a bar below shows when messages were not valid.";
  figure.chart.marked = invalidSpans(inputs.front().messages);
  figure.chart.marked_name = "not valid";
  figure.chart.unmarked_name = "valid";
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

std::vector<Figure> evaluationFigures(const std::vector<ReportInput>& inputs) {
  std::vector<Figure> figures{pathFigure(inputs), distanceFigure(inputs)};
  const auto has_times = [](const ReportInput& input) { return !secondsOf(input).empty(); };
  const auto has_segments = [](const ReportInput& input) { return !allSegments(input.evaluation).empty(); };
  if (std::all_of(inputs.begin(), inputs.end(), has_times)) figures.push_back(timeFigure(inputs));
  if (std::any_of(inputs.begin(), inputs.end(), has_segments)) figures.push_back(segmentFigure(inputs));
  const ReportInput& first = inputs.front();
  if (inputs.size() > 1 || first.messages.empty()) return figures;
  for (Figure& figure : motionFigures(first.messages))
    figures.push_back(std::move(figure));
  for (Figure& figure : boundFigures(judgedMessages(first.messages), first.limits))
    figures.push_back(std::move(figure));
  return figures;
}

Drawing evaluationPlot(const std::vector<ReportInput>& inputs) {
  Drawing drawing = drawChart(pathFigure(inputs).chart);
  drawing.addBelow(drawChart(distanceFigure(inputs).chart));
  return drawing;
}

}  // namespace cartvo
