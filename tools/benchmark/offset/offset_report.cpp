// Errors over the time offset as tables and as JSON.
#include "tools/benchmark/offset/offset_report.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "tools/benchmark/grouping.hpp"
#include "tools/benchmark/validity_cells.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

/// The result of two-instants on the same sequence without a time offset; null if it was not measured.
const OffsetAccuracy* synchronisedReference(const OffsetAccuracy& one,
                                            const std::vector<OffsetAccuracy>& all) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const OffsetAccuracy& other) {
    return other.sequence == one.sequence && other.clock == RightClock{} &&
           other.model == OffsetModel::two_instants;
  });
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::string> cells(const OffsetAccuracy& one, const std::vector<OffsetAccuracy>& all) {
  const SequenceAccuracy& a = one.accuracy;
  const Evaluation& e = a.evaluation;
  const ErrorCells errors = errorCells(e, ratiosOf(one, all));
  return withValidity(
      {one.sequence, clockName(one.clock), offsetModelName(one.model), std::to_string(a.pairs),
       errors.segments, errors.segment_ratios, errors.relative, errors.relative_ratios,
       e.final_drift_fraction ? significant(100.0 * *e.final_drift_fraction) : kNoValue,
       std::to_string(a.invalid), std::to_string(a.resets), neesCell(a.consistency.motion),
       neesCell(a.consistency.pose)},
      a.validity);
}

constexpr const char* kLegend =
    "right camera: its time offset, and how much slower its clock is. Errors of the left camera's path\n"
    "(cartvo-evaluate(1)): segments of 5 to 40 m (% and deg/m), from pair to pair (RPE, RMSE, mm and deg), "
    "final drift.\n"
    "x: as multiples of the errors of two-instants on the same sequence without a time offset. NEES: mean of "
    "the squared error over its "
    "covariance, per\n"
    "dimension: 1 is consistent.\n";

Json rowJson(const OffsetAccuracy& one, const std::vector<OffsetAccuracy>& all) {
  const SequenceAccuracy& a = one.accuracy;
  Json json{{"sequence", one.sequence},
            {"kind", a.kind == SequenceKind::real ? "real" : "rendered"},
            {"offset_ms", 1e3 * one.clock.offset_s},
            {"drift_ppm", one.clock.drift_ppm},
            {"model", offsetModelName(one.model)},
            {"pairs", a.pairs},
            {"invalid", a.invalid},
            {"lost", a.lost},
            {"resets", a.resets},
            {"evaluation", evaluationOfDrivesJson(a.evaluation)},
            {"ratio_to_0_ms", ratiosJson(ratiosOf(one, all))},
            {"nees_motion", neesJson(a.consistency.motion)},
            {"nees_pose", neesJson(a.consistency.pose)}};
  json.update(validityJson(a.validity));
  return json;
}

std::vector<OffsetAccuracy> withAllWorlds(std::vector<OffsetAccuracy> accuracies) {
  std::vector<OffsetAccuracy> together = allWorlds(accuracies);
  std::move(together.begin(), together.end(), std::back_inserter(accuracies));
  return accuracies;
}

}  // namespace

std::optional<ErrorRatios> ratiosOf(const OffsetAccuracy& one, const std::vector<OffsetAccuracy>& all) {
  const OffsetAccuracy* reference = synchronisedReference(one, all);
  if (reference == nullptr) return std::nullopt;
  return ratiosOf(one.accuracy.evaluation, reference->accuracy.evaluation);
}

std::vector<OffsetAccuracy> allWorlds(const std::vector<OffsetAccuracy>& accuracies) {
  std::vector<OffsetAccuracy> rendered;
  std::copy_if(accuracies.begin(), accuracies.end(), std::back_inserter(rendered),
               [](const OffsetAccuracy& one) { return one.accuracy.kind == SequenceKind::rendered; });
  const auto same = [](const OffsetAccuracy& a, const OffsetAccuracy& b) {
    return a.clock == b.clock && a.model == b.model;
  };
  std::vector<OffsetAccuracy> results;
  for (const std::vector<OffsetAccuracy>& group : grouped(rendered, same)) {
    if (group.size() < 2) continue;
    std::vector<SequenceAccuracy> worlds;
    for (const OffsetAccuracy& one : group)
      worlds.push_back(one.accuracy);
    const std::string name = "all " + std::to_string(group.size()) + " worlds";
    results.push_back({name, group.front().clock, group.front().model, summarise(name, worlds)});
  }
  return results;
}

std::string clockName(const RightClock& clock) {
  char text[64];
  if (clock.drift_ppm == 0.0) {
    std::snprintf(text, sizeof text, "%.4g ms", 1e3 * clock.offset_s);
  } else {
    std::snprintf(text, sizeof text, "%.3g ms %+.0f ppm", 1e3 * clock.offset_s, clock.drift_ppm);
  }
  return text;
}

std::string offsetTable(const std::vector<OffsetAccuracy>& accuracies, ReportFormat format) {
  Table table(withValidityColumns({"sequence", "right camera", "model", "pairs", "5–40 m: % / deg/m", "x",
                                   "RPE: mm / deg", "x", "drift, %", "invalid", "resets", "NEES motion",
                                   "NEES pose"}));
  const std::vector<OffsetAccuracy> all = withAllWorlds(accuracies);
  for (const OffsetAccuracy& one : all)
    table.add(cells(one, all));
  const auto model = [](const OffsetAccuracy& one) { return offsetModelName(one.model); };
  return table.as(format) + "\n" + validityTotals(accuracies, model) + "\n" + kLegend + kValidityLegend;
}

Json offsetJson(const std::vector<OffsetAccuracy>& accuracies) {
  const std::vector<OffsetAccuracy> all = withAllWorlds(accuracies);
  Json json{{"offsets", Json::array()}};
  for (const OffsetAccuracy& one : all)
    json["offsets"].push_back(rowJson(one, all));
  return json;
}

}  // namespace cartvo::benchmark
