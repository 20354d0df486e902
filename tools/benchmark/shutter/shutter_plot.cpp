// Plots errors over the readout and over the frequency of a vibration.
#include "tools/benchmark/shutter/shutter_plot.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/units.hpp"
#include "tools/benchmark/grouping.hpp"
#include "tools/benchmark/shutter/shutter_report.hpp"
#include "tools/report/diagram.hpp"

namespace cartvo::benchmark {
namespace {

/// The point of a result in a diagram; nothing if it does not belong there.
using PointOf = std::function<std::optional<cv::Point2d>(const ShutterAccuracy&)>;

DrawingColour colourOf(ReadoutModel model) {
  constexpr DrawingColour kBlue{20, 90, 190}, kGreen{20, 140, 70}, kRed{200, 40, 40};
  if (model == ReadoutModel::known) return kBlue;
  return model == ReadoutModel::estimated ? kGreen : kRed;
}

/// Curves of each world and model with points sorted by x. A result of a global shutter counts for all models
/// of its world: without a readout they are the same.
std::vector<DiagramCurve> curvesOf(const std::vector<ShutterAccuracy>& accuracies, double width,
                                   double opacity, const PointOf& point_of) {
  const auto same = [](const ShutterAccuracy& a, const ShutterAccuracy& b) {
    return a.sequence == b.sequence && a.model == b.model;
  };
  std::vector<DiagramCurve> curves;
  for (const std::vector<ShutterAccuracy>& group : grouped(accuracies, same)) {
    DiagramCurve curve{{}, colourOf(group.front().model), width, opacity};
    for (const ShutterAccuracy& one : accuracies) {
      const bool belongs = one.sequence == group.front().sequence &&
                           (one.model == group.front().model || one.seen.readout.isGlobal());
      if (const std::optional<cv::Point2d> point = belongs ? point_of(one) : std::nullopt)
        curve.points.push_back(*point);
    }
    std::sort(curve.points.begin(), curve.points.end(),
              [](const auto& a, const auto& b) { return a.x < b.x; });
    if (curve.points.size() > 1) curves.push_back(std::move(curve));
  }
  return curves;
}

std::optional<cv::Point2d> overReadout(const ShutterAccuracy& one, double value) {
  const ShutterCase& seen = one.seen;
  if (seen.readout.left != seen.readout.right || seen.readout.left < 0.0 || seen.clock != RightClock{} ||
      seen.shake.amplitude != 0.0 || one.accuracy.evaluation.short_segments.all.count == 0)
    return std::nullopt;
  return cv::Point2d(1e3 * seen.readout.left, value);
}

}  // namespace

Drawing shutterPlot(const std::vector<ShutterAccuracy>& accuracies) {
  const auto diagram = [&](const std::string& title, const std::string& x_title, double x_step,
                           const PointOf& point_of) {
    Diagram drawn{title, x_title, x_step, 70.0, 0.0, 600.0, 260.0, curvesOf(accuracies, 1.0, 0.6, point_of)};
    for (DiagramCurve& curve : curvesOf(allWorlds(accuracies), 3.0, 1.0, point_of))
      drawn.curves.push_back(std::move(curve));
    return drawn;
  };
  const char* readout = "readout (ms)";
  std::vector<Diagram> diagrams{
      diagram("translation over 5 to 40 m (%)", readout, 4.0,
              [](const ShutterAccuracy& one) {
                return overReadout(one, 100.0 * one.accuracy.evaluation.short_segments.all.translation);
              }),
      diagram("rotation over 5 to 40 m (deg/m)", readout, 4.0,
              [](const ShutterAccuracy& one) {
                return overReadout(one,
                                   kDegreesPerRadian * one.accuracy.evaluation.short_segments.all.rotation);
              }),
      diagram("error of the angular velocity of a shaken mount (%)", "frequency (Hz)", 1.0,
              [](const ShutterAccuracy& one) -> std::optional<cv::Point2d> {
                const bool is_shown = one.seen.shake.amplitude > 0.0 && !one.seen.readout.isGlobal() &&
                                      std::isfinite(one.rates.relative());
                if (!is_shown) return std::nullopt;
                return cv::Point2d(one.seen.shake.frequency, 100.0 * one.rates.relative());
              })};
  std::erase_if(diagrams, [](const Diagram& one) { return one.curves.empty(); });
  if (diagrams.empty())
    throw std::invalid_argument(
        "nothing to plot: a curve needs two readouts that are alike and not negative with an offset of 0, or "
        "two frequencies of a vibration; see --readouts-ms, --offsets-ms and --shake-hz");
  constexpr double kFirstTop = 70.0, kHeight = 340.0;
  Drawing drawing(700, static_cast<int>(50.0 + kHeight * static_cast<double>(diagrams.size())));
  double x = 70.0;
  for (const std::string& name : readoutModelNames()) {
    addLegendEntry(drawing, {x, 24.0}, colourOf(readoutModelNamed(name)), name);
    x += 160.0;
  }
  double top = kFirstTop;
  for (Diagram& one : diagrams) {
    one.top = top;
    addDiagram(drawing, one);
    top += kHeight;
  }
  return drawing;
}

}  // namespace cartvo::benchmark
