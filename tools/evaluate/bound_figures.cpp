// Stanford diagrams: errors of VALID messages against the bounds that they state.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "common/units.hpp"
#include "tools/evaluate/figures.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

/// One component of a message.
struct BoundedError {
  double seconds = 0.0;  ///< since the first message
  int axis = 0;
  double error = 0.0, bound = 0.0;

  double ratio() const { return std::isnan(bound) ? std::numeric_limits<double>::infinity() : error / bound; }
};

/// A quantity of messages, its unit in the diagram and its alert limit there.
struct Quantity {
  Eigen::Vector3d pipeline::ProtectionLevel::*member;
  std::array<const char*, 3> axes;
  const char* unit;
  double factor;
  double limit;
};

std::vector<BoundedError> boundedErrors(const std::vector<JudgedMessage>& messages,
                                        const Quantity& quantity) {
  std::vector<BoundedError> errors;
  for (const JudgedMessage& message : messages) {
    const double seconds = 1e-9 * static_cast<double>(message.time_ns - messages.front().time_ns);
    const Eigen::Vector3d error = quantity.factor * message.error.*quantity.member,
                          bound = quantity.factor * message.bound.*quantity.member;
    for (int axis = 0; axis < 3; ++axis)
      if (message.valid && !std::isnan(error[axis]))
        errors.push_back({seconds, axis, error[axis], bound[axis]});
  }
  return errors;
}

/// Full decades that contain the limit and the values, at most three below it and four above.
std::pair<double, double> decadesOf(const std::vector<BoundedError>& errors, double limit) {
  constexpr double kBelow = 1e-3, kAbove = 1e4;
  double high = 2.0 * limit;
  for (const BoundedError& one : errors) {
    for (const double value : {one.error, one.bound})
      if (value > high) high = std::min(value, kAbove * limit);
  }
  return {std::pow(10.0, std::floor(std::log10(kBelow * limit))),
          std::pow(10.0, std::ceil(std::log10(high)))};
}

/// Distinct dots: thousands of messages would make a page slow without showing more.
std::vector<cv::Point2d> distinctDots(const std::vector<BoundedError>& errors, bool above_bound, double low,
                                      double high) {
  constexpr double kCellsPerDecade = 25.0;
  std::set<std::pair<long, long>> cells;
  std::vector<cv::Point2d> dots;
  for (const BoundedError& one : errors) {
    if ((one.ratio() > 1.0) != above_bound) continue;
    const cv::Point2d dot(std::clamp(one.error, low, high),
                          std::isnan(one.bound) ? low : std::clamp(one.bound, low, high));
    const auto cell = [](double value) { return std::lround(kCellsPerDecade * std::log10(value)); };
    if (cells.emplace(cell(dot.x), cell(dot.y)).second) dots.push_back(dot);
  }
  return dots;
}

Figure boundFigure(const std::vector<JudgedMessage>& messages, const Quantity& quantity) {
  std::vector<BoundedError> errors = boundedErrors(messages, quantity);
  const auto [low, high] = decadesOf(errors, quantity.limit);
  const double nan = std::numeric_limits<double>::quiet_NaN(), limit = quantity.limit;
  Figure figure;
  figure.chart.is_x_logarithmic = true;
  figure.chart.x_title = std::string("error (") + quantity.unit + ")";
  ChartPanel panel;
  panel.y_title = std::string("bound (") + quantity.unit + ")";
  panel.is_logarithmic = true;
  panel.height = 400;
  panel.series = {{"within its bound", kChartBlue, distinctDots(errors, false, low, high), SeriesStyle::dots},
                  {"above its bound", kChartRed, distinctDots(errors, true, low, high), SeriesStyle::dots},
                  {"error = bound", kChartInk, {{low, low}, {high, high}}},
                  {"alert limit",
                   kChartGreen,
                   {{low, limit}, {high, limit}, {high, nan}, {limit, low}, {limit, high}},
                   SeriesStyle::dashed}};
  figure.chart.panels = {std::move(panel)};
  figure.columns = {"time (s)", "component", figure.chart.x_title, figure.chart.panels[0].y_title};
  const std::size_t shown = spreadIndices(errors.size()).size();
  std::partial_sort(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(shown), errors.end(),
                    [](const BoundedError& a, const BoundedError& b) { return a.ratio() > b.ratio(); });
  errors.resize(shown);
  for (const BoundedError& one : errors) {
    figure.rows.push_back({fixed(one.seconds, 2), quantity.axes[static_cast<std::size_t>(one.axis)],
                           significant(one.error),
                           std::isnan(one.bound) ? kNoValue : significant(one.bound)});
  }
  return figure;
}

}  // namespace

std::vector<Figure> boundFigures(const std::vector<JudgedMessage>& messages,
                                 const pipeline::AlertLimits& limits) {
  Figure velocity = boundFigure(
      messages,
      {&pipeline::ProtectionLevel::velocity, {"forward", "left", "up"}, "m/s", 1.0, limits.velocity});
  velocity.name = "velocity-bounds";
  velocity.chart.title = "Error of velocities against their bound (Stanford diagram)";
  velocity.caption =
      "Each dot is a component of the velocity of a VALID message, and dots in the same place are one. Below "
      "the line "
      "the "
      "error is above the bound that the message states; to the right of the upright dashed line it is above "
      "the alert "
      "limit. A message with a bound above the level dashed line is not VALID. The table has those nearest "
      "to "
      "their bound or above it.";
  Figure rates = boundFigure(messages, {&pipeline::ProtectionLevel::angular_rate,
                                        {"roll rate", "pitch rate", "yaw rate"},
                                        "deg/s",
                                        kDegreesPerRadian,
                                        kDegreesPerRadian * limits.angular_rate});
  rates.name = "rate-bounds";
  rates.chart.title = "Error of angular rates against their bound (Stanford diagram)";
  rates.caption = "As for velocities.";
  std::vector<Figure> figures{std::move(velocity), std::move(rates)};
  std::erase_if(figures, [](const Figure& figure) { return figure.rows.empty(); });
  return figures;
}

}  // namespace cartvo
