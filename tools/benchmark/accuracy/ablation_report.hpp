#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy/accuracy.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The ablation table, text or Markdown: one row per variant (the `estimator` of an accuracy), one column per
/// sequence, then the segments of all rendered drives together and the median time of a pair, ms.
/// `accuracies` must contain each variant over the same sequences, as returned by runAccuracyBenchmark.
std::string ablationTable(const std::vector<SequenceAccuracy>& accuracies, ReportFormat format);

/// The output of accuracyJson and the key `variants`, which maps the name of each variant to its description.
nlohmann::ordered_json ablationJson(const std::vector<SequenceAccuracy>& accuracies);

}  // namespace cartvo::benchmark
