// Figures of velocities, rates and their consistency.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/units.hpp"
#include "tools/evaluate/consistency.hpp"
#include "tools/evaluate/figures.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Messages = std::vector<ComparedMessage>;

double secondsAt(const Messages& messages, std::size_t index) {
  return 1e-9 * static_cast<double>(messages[index].time_ns - messages.front().time_ns);
}

std::string valueText(double value, int decimals) {
  return std::isfinite(value) ? fixed(value, decimals) : kNoValue;
}

/// RMSE of one component of the twist; NaN if no message has a truth.
double rootMeanSquare(const Messages& messages, int axis) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const ComparedMessage& message : messages) {
    const double error = message.twist[axis] - message.true_twist[axis];
    if (!std::isfinite(error)) continue;
    sum += error * error;
    ++count;
  }
  return count == 0 ? kNaN : std::sqrt(sum / static_cast<double>(count));
}

/// One component of the twist over time, with twice its standard deviation.
ChartPanel twistPanel(const Messages& messages, int axis, const std::string& name, const std::string& unit,
                      double factor) {
  ChartSeries truth{"truth", kChartInk, {}, SeriesStyle::dashed}, estimate{"estimate", kChartBlue, {}};
  ChartBand band{"estimate ±2 σ", kChartBlue, {}};
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const double seconds = secondsAt(messages, i);
    const double value = factor * messages[i].twist[axis];
    const double width = 2.0 * factor * messages[i].twist_stddev[axis];
    truth.points.emplace_back(seconds, factor * messages[i].true_twist[axis]);
    estimate.points.emplace_back(seconds, value);
    band.limits.push_back({seconds, value - width, value + width});
  }
  ChartPanel panel;
  panel.y_title = name + " (" + unit + "), RMSE " + valueText(factor * rootMeanSquare(messages, axis), 3);
  panel.series = {std::move(estimate), std::move(truth)};
  panel.bands = {std::move(band)};
  panel.height = 115;
  return panel;
}

/// Velocities (`first_axis` 0) or rates (3).
Figure twistFigure(const Messages& messages, int first_axis, const std::array<std::string, 3>& names,
                   const std::string& unit, double factor) {
  Figure figure;
  figure.columns = {"time (s)"};
  for (int i = 0; i < 3; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    figure.chart.panels.push_back(twistPanel(messages, first_axis + i, name, unit, factor));
    for (const char* part : {"", " truth", " σ"})
      figure.columns.push_back(name + part + " (" + unit + ")");
  }
  for (const std::size_t index : spreadIndices(messages.size())) {
    std::vector<std::string> row{fixed(secondsAt(messages, index), 2)};
    for (int axis = first_axis; axis < first_axis + 3; ++axis) {
      const ComparedMessage& message = messages[index];
      for (const double value : {message.twist[axis], message.true_twist[axis], message.twist_stddev[axis]})
        row.push_back(valueText(factor * value, 3));
    }
    figure.rows.push_back(std::move(row));
  }
  return figure;
}

using Nees = std::optional<double> ComparedMessage::*;

std::vector<double> valuesOf(const Messages& messages, Nees member) {
  std::vector<double> values;
  for (const ComparedMessage& message : messages)
    if (message.*member) values.push_back(*(message.*member));
  return values;
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Mean and share inside the interval, such as "mean 1.1, 93 % inside".
std::string neesText(const std::vector<double>& values, const Interval& interval) {
  const auto inside =
      std::count_if(values.begin(), values.end(), [&](double value) { return interval.contains(value); });
  return "mean " + significant(meanOf(values)) + ", " +
         fixed(100.0 * static_cast<double>(inside) / static_cast<double>(values.size()), 0) + " % inside";
}

constexpr std::array<std::pair<const char*, Nees>, 2> kConsistencies{
    {{"velocities and rates", &ComparedMessage::twist_nees},
     {"pose in its epoch", &ComparedMessage::pose_nees}}};

/// Whether the stated deviations are right, in words. A factor on a deviation is the root of that on NEES.
std::string verdictText(const std::vector<double>& values, const std::string& name) {
  if (values.empty())
    return "Of the " + name +
           " there is no value: no VALID message with a motion has a truth and a usable covariance.";
  constexpr double kRight = 1.5;  // factor on the deviation
  const double factor = std::sqrt(meanOf(values));
  if (factor > kRight)
    return "The errors of the " + name + " are " + significant(factor) +
           " times the stated deviation: it is too small here.";
  if (factor < 1.0 / kRight)
    return "The stated deviation of the " + name + " is " + significant(1.0 / std::max(factor, 1e-6)) +
           " times too large here.";
  return "The stated deviation of the " + name + " fits the errors.";
}

ChartPanel neesPanel(const Messages& messages, const std::string& name, Nees member) {
  const Interval interval = consistencyBand(1);
  ChartSeries series{"NEES / 6", kChartBlue, {}}, one{"1: consistent", kChartInk, {}, SeriesStyle::dashed};
  ChartBand band{"95 % of χ²(6) / 6", kChartGreen, {}};
  for (std::size_t i = 0; i < messages.size(); ++i)
    series.points.emplace_back(secondsAt(messages, i), (messages[i].*member).value_or(kNaN));
  const double end = secondsAt(messages, messages.size() - 1);
  one.points = {{0.0, 1.0}, {end, 1.0}};
  band.limits = {{0.0, interval.low, interval.high}, {end, interval.low, interval.high}};
  ChartPanel panel;
  panel.y_title = name + ": " + neesText(valuesOf(messages, member), interval);
  panel.series = {std::move(series), std::move(one)};
  panel.bands = {std::move(band)};
  panel.is_logarithmic = true;
  panel.height = 140;
  return panel;
}

Figure neesFigure(const Messages& messages) {
  Figure figure;
  figure.name = "nees";
  figure.chart.title = "Consistency of covariances (NEES) over time";
  for (const auto& [name, member] : kConsistencies) {
    if (!valuesOf(messages, member).empty()) figure.chart.panels.push_back(neesPanel(messages, name, member));
  }
  figure.caption =
      consistencyVerdict(messages) +
      " Squared error over its covariance, divided by the six dimensions. If covariances are right, 95 % of "
      "the values lie in the interval; above it errors are larger than stated. Errors of poses are "
      "correlated: each contains those before. An error of the truth counts as one of the estimate.";
  figure.columns = {"time (s)", "velocities and rates", "pose in its epoch"};
  const auto text = [](const std::optional<double>& nees) { return nees ? significant(*nees) : kNoValue; };
  for (const std::size_t index : spreadIndices(messages.size())) {
    const ComparedMessage& message = messages[index];
    figure.rows.push_back(
        {fixed(secondsAt(messages, index), 2), text(message.twist_nees), text(message.pose_nees)});
  }
  return figure;
}

}  // namespace

std::string consistencyVerdict(const Messages& messages) {
  std::string text;
  for (const auto& [name, member] : kConsistencies)
    text += (text.empty() ? "" : " ") + verdictText(valuesOf(messages, member), name);
  return text;
}

std::vector<ChartSpan> invalidSpans(const Messages& messages) {
  std::vector<ChartSpan> spans;
  for (std::size_t i = 1; i < messages.size(); ++i) {
    if (messages[i].valid) continue;
    const double from = secondsAt(messages, i),
                 to = secondsAt(messages, std::min(i + 1, messages.size() - 1));
    if (!spans.empty() && spans.back().to == from) {
      spans.back().to = to;
    } else {
      spans.push_back({from, to});
    }
  }
  return spans;
}

std::vector<Figure> motionFigures(const Messages& messages) {
  Figure velocities = twistFigure(messages, 0, {"forward", "left", "up"}, "m/s", 1.0);
  velocities.name = "velocities";
  velocities.chart.title = "Velocity in body axes over time";
  velocities.caption =
      "Velocity of the body's origin as published, with twice its standard deviation. The true velocity is "
      "the "
      "mean over two periods of the truth, or 50 ms if they are shorter.";
  Figure rates =
      twistFigure(messages, 3, {"roll rate", "pitch rate", "yaw rate"}, "deg/s", kDegreesPerRadian);
  rates.name = "rates";
  rates.chart.title = "Angular rates in body axes over time";
  rates.caption = "Rates about the forward, left and upward axis as published; the truth as for velocities.";
  std::vector<Figure> figures{std::move(velocities), std::move(rates), neesFigure(messages)};
  // Without an estimate there is nothing to draw; the page says so in words.
  const bool has_valid =
      std::any_of(messages.begin(), messages.end(), [](const auto& one) { return one.valid; });
  if (!has_valid) figures.clear();
  std::erase_if(figures, [](const Figure& figure) { return figure.chart.panels.empty(); });
  const std::vector<ChartSpan> invalid = invalidSpans(messages);
  for (Figure& figure : figures) {
    figure.chart.x_title = "time (s)";
    figure.chart.marked = invalid;
    figure.chart.marked_name = "not valid";
    figure.chart.unmarked_name = "valid";
  }
  return figures;
}

}  // namespace cartvo
