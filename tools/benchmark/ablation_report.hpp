#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// A row for each variant (`estimator` of the accuracies), a column for each sequence, then all rendered
/// worlds that are driven through together and the time of a pair. `accuracies`: each variant over the same
/// sequences, as runAccuracyBenchmark gives them. Text or Markdown.
std::string ablationTable(const std::vector<SequenceAccuracy>& accuracies, ReportFormat format);

/// The same for programs: accuracyJson's, and `variants`, what each name means.
nlohmann::ordered_json ablationJson(const std::vector<SequenceAccuracy>& accuracies);

}  // namespace cartvo::benchmark
