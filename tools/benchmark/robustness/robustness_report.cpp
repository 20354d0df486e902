// Results of the robustness benchmark as a table and as JSON.
#include "tools/benchmark/robustness/robustness_report.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLegend =
    "valid: pairs with a valid motion, of all but the first. wrong: valid, but off by more than 5 cm or 0.5 "
    "deg "
    "and five\n"
    "standard deviations. error: of the path over each second, root mean square, mm; a second without an "
    "estimate counts\n"
    "with its whole motion. x: over the untouched sequence. worse: than `estimator: thesis`, by more than "
    "chance.\n";

std::string validCell(const SequenceAccuracy& accuracy) {
  const std::size_t all = std::max<std::size_t>(accuracy.pairs, 1) - 1;
  return fmt::format("{} of {}", all - std::min(all, accuracy.invalid), all);
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
          validCell(a),
          std::to_string(a.wrong),
          std::to_string(a.resets),
          fault ? kNoValue : errorCell(row.reprojection),
          fault ? kNoValue : ratioCell(row),
          validCell(b),
          std::to_string(b.wrong),
          std::to_string(b.resets),
          fault ? kNoValue : errorCell(row.thesis),
          row.isWorse() ? "worse" : ""};
}

std::size_t countWorse(const std::vector<RobustnessRow>& rows) {
  return std::count_if(rows.begin(), rows.end(), [](const RobustnessRow& row) { return row.isWorse(); });
}

std::size_t countWrong(const std::vector<RobustnessRow>& rows) {
  return std::count_if(rows.begin(), rows.end(),
                       [](const RobustnessRow& row) { return row.reprojection.accuracy.wrong > 0; });
}

Json estimatorJson(const DisturbedAccuracy& one) {
  const SequenceAccuracy& accuracy = one.accuracy;
  return {{"pairs", accuracy.pairs},
          {"invalid", accuracy.invalid},
          {"wrong_while_valid", accuracy.wrong},
          {"resets", accuracy.resets},
          {"error_per_second_m", one.errors_per_second.empty() ? Json(nullptr) : Json(one.error())},
          {"errors_per_second_m", one.errors_per_second}};
}

}  // namespace

std::string robustnessTable(const std::vector<RobustnessRow>& rows, ReportFormat format) {
  Table table({"sequence", "disturbance", "valid", "wrong", "resets", "error", "x", "thesis: valid", "wrong",
               "resets", "error", ""});
  for (const RobustnessRow& row : rows)
    table.add(cells(row));
  return table.as(format) + "\n" + kLegend +
         fmt::format("The default is worse than the thesis in {} of {} rows, and wrong while valid in {}.\n",
                     countWorse(rows), rows.size(), countWrong(rows));
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
  json["wrong_while_valid"] = countWrong(rows);
  return json;
}

}  // namespace cartvo::benchmark
