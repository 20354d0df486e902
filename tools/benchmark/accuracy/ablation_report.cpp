// Ablation results as a table and as JSON.
#include "tools/benchmark/accuracy/ablation_report.hpp"

#include <algorithm>

#include "common/statistics.hpp"
#include "common/units.hpp"
#include "tools/benchmark/accuracy/ablation_variants.hpp"
#include "tools/benchmark/accuracy/accuracy_report.hpp"

namespace cartvo::benchmark {
namespace {

/// The distinct values of one name field, in order of first occurrence.
std::vector<std::string> distinctNames(const std::vector<SequenceAccuracy>& accuracies,
                                       std::string SequenceAccuracy::*name) {
  std::vector<std::string> names;
  for (const SequenceAccuracy& accuracy : accuracies) {
    if (std::find(names.begin(), names.end(), accuracy.*name) == names.end()) names.push_back(accuracy.*name);
  }
  return names;
}

std::vector<SequenceAccuracy> selectVariant(const std::vector<SequenceAccuracy>& accuracies,
                                            const std::string& variant) {
  std::vector<SequenceAccuracy> selected;
  std::copy_if(accuracies.begin(), accuracies.end(), std::back_inserter(selected),
               [&](const SequenceAccuracy& accuracy) { return accuracy.estimator == variant; });
  return selected;
}

bool isDrive(const SequenceAccuracy& accuracy) {
  return accuracy.evaluation.short_segments.all.count > 0;
}

std::string segmentCell(const SequenceAccuracy& accuracy) {
  const SegmentErrors& errors = accuracy.evaluation.short_segments.all;
  return significant(100.0 * errors.translation) + " / " + significant(kDegreesPerRadian * errors.rotation);
}

std::string cell(const SequenceAccuracy& accuracy) {
  std::string text = kNoValue;
  if (isDrive(accuracy)) {
    text = segmentCell(accuracy);
  } else if (accuracy.standing_end) {
    text = "end " + significant(1e3 * accuracy.standing_end->translation) + " mm / " +
           significant(kDegreesPerRadian * accuracy.standing_end->rotation) + "°";
  }
  if (accuracy.invalid > 0) text += ", " + std::to_string(accuracy.invalid) + " invalid";
  if (const std::size_t above = accuracy.validity.above_limit; above > 0)
    text += ", " + std::to_string(above) + " above limit";
  return text;
}

std::string worldsCell(std::vector<SequenceAccuracy> accuracies) {
  std::erase_if(accuracies, [](const SequenceAccuracy& accuracy) {
    return accuracy.kind != SequenceKind::rendered || !isDrive(accuracy);
  });
  return accuracies.empty() ? kNoValue : segmentCell(summarise("worlds", accuracies));
}

std::string timeCell(const std::vector<SequenceAccuracy>& accuracies) {
  std::vector<double> times;
  for (const SequenceAccuracy& accuracy : accuracies)
    times.insert(times.end(), accuracy.times_ms.begin(), accuracy.times_ms.end());
  return times.empty() ? kNoValue : fixed(percentile(times, 0.5), 1);
}

std::string legend(const std::vector<std::string>& variants) {
  std::string text =
      "Errors of the left camera's path over segments of 5 to 40 m (% / deg/m; cartvo-evaluate(1)), or the "
      "error of the\n"
      "last pose if the camera does not move. worlds: the segments of all rendered drives together. ms: "
      "median "
      "time of a\n"
      "pair.\n";
  for (const Ablation& ablation : ablations()) {
    if (std::find(variants.begin(), variants.end(), ablation.name) != variants.end())
      text.append(ablation.name).append(": ").append(ablation.description).append("\n");
  }
  return text;
}

}  // namespace

std::string ablationTable(const std::vector<SequenceAccuracy>& accuracies, ReportFormat format) {
  std::vector<std::string> header = distinctNames(accuracies, &SequenceAccuracy::sequence);
  header.insert(header.begin(), "variant");
  header.insert(header.end(), {"worlds", "ms"});
  Table table(header);
  const std::vector<std::string> variants = distinctNames(accuracies, &SequenceAccuracy::estimator);
  for (const std::string& variant : variants) {
    const std::vector<SequenceAccuracy> selected = selectVariant(accuracies, variant);
    std::vector<std::string> row{variant};
    for (const SequenceAccuracy& accuracy : selected)
      row.push_back(cell(accuracy));
    row.push_back(worldsCell(selected));
    row.push_back(timeCell(selected));
    table.add(std::move(row));
  }
  return table.as(format) + "\n" + legend(variants);
}

nlohmann::ordered_json ablationJson(const std::vector<SequenceAccuracy>& accuracies) {
  nlohmann::ordered_json json = accuracyJson(accuracies);
  for (const Ablation& ablation : ablations())
    json["variants"][ablation.name] = ablation.description;
  return json;
}

}  // namespace cartvo::benchmark
