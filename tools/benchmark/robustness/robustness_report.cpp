// Results of the robustness benchmark as a table and as JSON.
#include "tools/benchmark/robustness/robustness_report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "tools/benchmark/validity_cells.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLegend =
    "error: of the path over each second, root mean "
    "square, mm; a second without an "
    "estimate counts\n"
    "with its whole motion. x: over the untouched sequence. worse: than `estimator: thesis`, by more than "
    "chance.\n";

std::string availableCell(const SequenceAccuracy& accuracy) {
  return fixed(100.0 * accuracy.validity.availability(), 1);
}

std::string errorCell(const DisturbedAccuracy& one) {
  return one.errors_per_second.empty() ? kNoValue : significant(1e3 * one.error());
}

std::string ratioCell(const RobustnessRow& row) {
  if (row.reprojection.errors_per_second.empty() || row.untouched_error == 0.0) return kNoValue;
  return significant(row.reprojection.error() / row.untouched_error);
}

std::vector<std::string> cells(const RobustnessRow& row) {
  const SequenceAccuracy &a = row.reprojection.accuracy, &b = row.thesis.accuracy;
  const bool fault = row.disturbance.kind == DisturbanceKind::rig;
  return {row.sequence,
          row.disturbance.name,
          std::to_string(a.validity.above_limit),
          std::to_string(a.validity.above_bound),
          availableCell(a),
          fixed(a.validity.longest_gap, 2),
          std::to_string(a.resets),
          fault ? kNoValue : errorCell(row.reprojection),
          fault ? kNoValue : ratioCell(row),
          availableCell(b),
          std::to_string(b.validity.above_limit),
          std::to_string(b.resets),
          fault ? kNoValue : errorCell(row.thesis),
          row.isWorse() ? "worse" : ""};
}

std::size_t countWorse(const std::vector<RobustnessRow>& rows) {
  return std::count_if(rows.begin(), rows.end(), [](const RobustnessRow& row) { return row.isWorse(); });
}

/// Of the default.
ValidityFigures allMessages(const std::vector<RobustnessRow>& rows) {
  ValidityFigures all;
  for (const RobustnessRow& row : rows)
    all.add(row.reprojection.accuracy.validity);
  return all;
}

Json estimatorJson(const DisturbedAccuracy& one) {
  const SequenceAccuracy& accuracy = one.accuracy;
  Json json{{"pairs", accuracy.pairs},
            {"invalid", accuracy.invalid},
            {"resets", accuracy.resets},
            {"error_per_second_m", one.errors_per_second.empty() ? Json(nullptr) : Json(one.error())},
            {"errors_per_second_m", one.errors_per_second}};
  json.update(validityJson(accuracy.validity));
  return json;
}

}  // namespace

std::string robustnessTable(const std::vector<RobustnessRow>& rows, ReportFormat format) {
  Table table({"sequence", "disturbance", "> limit", "> bound", "available, %", "gap, s", "resets", "error",
               "x", "thesis: available, %", "> limit", "resets", "error", ""});
  for (const RobustnessRow& row : rows)
    table.add(cells(row));
  return table.as(format) + "\n" + kLegend + kValidityLegend +
         fmt::format("The default is worse than the thesis in {} of {} rows. All its messages: {}\n",
                     countWorse(rows), rows.size(), validityLine(allMessages(rows)));
}

Json robustnessJson(const std::vector<RobustnessRow>& rows) {
  Json json{{"rows", Json::array()}};
  for (const RobustnessRow& row : rows)
    json["rows"].push_back({{"sequence", row.sequence},
                            {"disturbance", row.disturbance.name},
                            {"reprojection", estimatorJson(row.reprojection)},
                            {"thesis", estimatorJson(row.thesis)},
                            {"untouched_error_m", row.untouched_error},
                            {"worse", row.isWorse()}});
  json["worse"] = countWorse(rows);
  json.update(validityJson(allMessages(rows)));
  return json;
}

}  // namespace cartvo::benchmark
