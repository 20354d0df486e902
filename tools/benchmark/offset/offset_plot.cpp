// Plots segment errors over the time offset.
#include "tools/benchmark/offset/offset_plot.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "tools/benchmark/offset/offset_report.hpp"
#include "tools/report/diagram.hpp"

namespace cartvo::benchmark {
namespace {

struct Curve {
  OffsetModel model;
  DiagramCurve drawn;
};

DrawingColour colourOf(OffsetModel model) {
  constexpr DrawingColour kBlue{20, 90, 190}, kRed{200, 40, 40};
  return model == OffsetModel::two_instants ? kBlue : kRed;
}

void drawLegend(Drawing& drawing, const std::vector<Curve>& curves, double y) {
  double x = 70.0;
  for (const std::string& name : offsetModelNames()) {
    const OffsetModel model = offsetModelNamed(name);
    if (std::none_of(curves.begin(), curves.end(), [&](const Curve& curve) { return curve.model == model; }))
      continue;
    addLegendEntry(drawing, {x, y}, colourOf(model), name);
    x += 160.0;
  }
}

/// The curves of one value, with points sorted by offset.
std::vector<Curve> curvesOf(const std::vector<OffsetAccuracy>& accuracies, bool of_all,
                            const std::function<double(const SegmentErrors&)>& value) {
  std::vector<Curve> curves;
  std::vector<std::string> sequences;
  for (const OffsetAccuracy& one : accuracies) {
    const SegmentErrors& segments = one.accuracy.evaluation.short_segments.all;
    if (one.clock.drift_ppm != 0.0 || one.accuracy.kind != SequenceKind::rendered || segments.count == 0)
      continue;
    std::size_t index = 0;
    while (index < curves.size() && (sequences[index] != one.sequence || curves[index].model != one.model))
      ++index;
    if (index == curves.size()) {
      curves.push_back({one.model, {{}, colourOf(one.model), of_all ? 3.0 : 1.0, of_all ? 1.0 : 0.6}});
      sequences.push_back(one.sequence);
    }
    curves[index].drawn.points.emplace_back(1e3 * one.clock.offset_s, value(segments));
  }
  for (Curve& curve : curves)
    std::sort(curve.drawn.points.begin(), curve.drawn.points.end(),
              [](const auto& a, const auto& b) { return a.x < b.x; });
  return curves;
}

void drawDiagram(Drawing& drawing, const std::string& title, double top, const std::vector<Curve>& curves) {
  Diagram diagram{title, "right camera later by (ms)", 5.0, 70.0, top, 600.0, 260.0, {}};
  for (const Curve& curve : curves)
    diagram.curves.push_back(curve.drawn);
  addDiagram(drawing, diagram);
}

}  // namespace

Drawing offsetPlot(const std::vector<OffsetAccuracy>& accuracies) {
  const auto both = [&](const std::function<double(const SegmentErrors&)>& value) {
    std::vector<Curve> curves = curvesOf(accuracies, false, value);
    for (Curve& curve : curvesOf(allWorlds(accuracies), true, value))
      curves.push_back(std::move(curve));
    return curves;
  };
  const std::vector<Curve> translation = both([](const SegmentErrors& e) { return 100.0 * e.translation; });
  const std::vector<Curve> rotation =
      both([](const SegmentErrors& e) { return 180.0 / std::numbers::pi * e.rotation; });
  if (translation.empty())
    throw std::invalid_argument(
        "nothing to plot: no rendered world has a constant offset; measure one with --scenarios and "
        "--offsets-ms");
  Drawing drawing(700, 730);
  drawLegend(drawing, translation, 24.0);
  drawDiagram(drawing, "translation over 5 to 40 m (%)", 70.0, translation);
  drawDiagram(drawing, "rotation over 5 to 40 m (deg/m)", 410.0, rotation);
  return drawing;
}

}  // namespace cartvo::benchmark
