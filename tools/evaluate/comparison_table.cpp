// Tables of several estimates.
#include "tools/evaluate/comparison_table.hpp"

#include "common/units.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

std::string percentOf(const SegmentErrors& errors) {
  return errors.count == 0 ? kNoValue : fixed(100.0 * errors.translation, 3);
}

std::vector<std::string> rowOf(const ReportInput& input) {
  const Evaluation& evaluation = input.evaluation;
  const bool has_messages = !input.messages.empty();
  return {input.estimate,
          std::to_string(evaluation.poses),
          fixed(evaluation.path_length, 2),
          fixed(evaluation.final_drift, 3),
          evaluation.final_drift_fraction ? fixed(100.0 * *evaluation.final_drift_fraction, 3) : kNoValue,
          fixed(evaluation.relative_translation, 4),
          fixed(kDegreesPerRadian * evaluation.relative_rotation, 4),
          fixed(evaluation.absolute_aligned, 4),
          percentOf(evaluation.short_segments.all),
          percentOf(evaluation.long_segments.all),
          has_messages
              ? fixed(100.0 * validityFigures(judgedMessages(input.messages), input.limits).availability(), 2)
              : kNoValue};
}

}  // namespace

ComparisonTable comparisonTable(const std::vector<ReportInput>& inputs) {
  ComparisonTable table;
  table.header = {"estimate",  "poses",   "path (m)",      "drift (m)",        "drift (%)", "RPE (m)",
                  "RPE (deg)", "ATE (m)", "5 to 40 m (%)", "100 to 800 m (%)", "VALID (%)"};
  Table text(table.header);
  std::string problems;
  for (const ReportInput& input : inputs) {
    table.rows.push_back(rowOf(input));
    text.add(table.rows.back());
    for (const std::string& problem : input.evaluation.problems)
      problems += "problem: " + input.estimate + ": " + problem + "\n";
  }
  table.text = text.text() + problems;
  return table;
}

}  // namespace cartvo
