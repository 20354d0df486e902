// Geometric means, extremes and counts of the worlds of one set.
#include "tools/benchmark/accuracy/set_summary.hpp"

#include <algorithm>
#include <cmath>

#include "tools/report/table.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

void addWorld(SetSummary& summary, const SequenceAccuracy& accuracy) {
  summary.worlds.push_back(accuracy);
  summary.invalid += accuracy.invalid;
  summary.validity.add(accuracy.validity);
  const SegmentErrors& segments = accuracy.evaluation.short_segments.all;
  if (segments.count > 0 && (!summary.segment_worst || segments.translation > summary.segment_worst->value))
    summary.segment_worst = {segments.translation, accuracy.sequence};
  if (accuracy.consistency.motion.groups() == 0) return;
  const WorldValue nees{accuracy.consistency.motion.mean(), accuracy.sequence};
  if (!summary.nees_lowest || nees.value < summary.nees_lowest->value) summary.nees_lowest = nees;
  if (!summary.nees_highest || nees.value > summary.nees_highest->value) summary.nees_highest = nees;
}

std::optional<double> geometricMean(const std::vector<SequenceAccuracy>& worlds) {
  double sum = 0.0;
  int count = 0;
  for (const SequenceAccuracy& world : worlds) {
    const SegmentErrors& segments = world.evaluation.short_segments.all;
    if (segments.count == 0 || !(segments.translation > 0.0)) continue;
    sum += std::log(segments.translation);
    ++count;
  }
  return count == 0 ? std::nullopt : std::optional(std::exp(sum / count));
}

Json valueJson(const std::optional<WorldValue>& value, double factor) {
  if (!value) return nullptr;
  return {{"value", factor * value->value}, {"world", value->world}};
}

}  // namespace

std::vector<SetSummary> setSummaries(const std::vector<SequenceAccuracy>& accuracies) {
  std::vector<SetSummary> summaries;
  for (const SequenceAccuracy& accuracy : accuracies) {
    if (accuracy.kind != SequenceKind::rendered || accuracy.bitrate_mbps > 0.0) continue;
    auto found = std::find_if(summaries.begin(), summaries.end(), [&](const SetSummary& summary) {
      return summary.estimator == accuracy.estimator && summary.set == accuracy.set;
    });
    if (found == summaries.end()) {
      SetSummary summary;
      summary.estimator = accuracy.estimator;
      summary.set = accuracy.set;
      found = summaries.insert(summaries.end(), summary);
    }
    addWorld(*found, accuracy);
  }
  for (SetSummary& summary : summaries)
    summary.segment_mean = geometricMean(summary.worlds);
  return summaries;
}

std::string setName(const std::optional<WorldSet>& set) {
  return set ? std::string(worldSetName(*set)) : "neither";
}

std::string summaryLine(const SetSummary& summary) {
  std::string line = setName(summary.set) + " set, " + summary.estimator + ", " +
                     std::to_string(summary.worlds.size()) + " worlds: ";
  if (summary.segment_mean && summary.segment_worst) {
    line += "5–40 m: geometric mean " + significant(100.0 * *summary.segment_mean) + " %, worst " +
            significant(100.0 * summary.segment_worst->value) + " % (" + summary.segment_worst->world + "); ";
  }
  if (summary.nees_lowest && summary.nees_highest) {
    line += "NEES motion " + fixed(summary.nees_lowest->value, 2) + " (" + summary.nees_lowest->world +
            ") to " + fixed(summary.nees_highest->value, 2) + " (" + summary.nees_highest->world + "); ";
  }
  return line + std::to_string(summary.invalid) + " invalid; " + validityLine(summary.validity);
}

Json setSummaryJson(const SetSummary& summary) {
  Json json{{"set", setName(summary.set)},
            {"estimator", summary.estimator},
            {"worlds", summary.worlds.size()},
            {"segments_5_to_40_m_geometric_mean_percent", nullptr},
            {"segments_5_to_40_m_worst_percent", valueJson(summary.segment_worst, 100.0)},
            {"nees_motion_lowest", valueJson(summary.nees_lowest, 1.0)},
            {"nees_motion_highest", valueJson(summary.nees_highest, 1.0)},
            {"invalid", summary.invalid}};
  json.update(validityJson(summary.validity));
  if (summary.segment_mean) json["segments_5_to_40_m_geometric_mean_percent"] = 100.0 * *summary.segment_mean;
  return json;
}

}  // namespace cartvo::benchmark
