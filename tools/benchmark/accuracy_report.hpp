#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The KPI table: a row for each accuracy, then one for each estimator over all rendered worlds (pictures as
/// they are), what the columns mean, and, where there are bit rates, accuracy over bit rate. Text or
/// Markdown.
std::string accuracyTable(const std::vector<SequenceAccuracy>& accuracies, ReportFormat format);

/// The same for programs: `sequences` and `summaries` (of one form) and `bitrates`; each key carries its
/// unit. What does not apply is null.
nlohmann::ordered_json accuracyJson(const std::vector<SequenceAccuracy>& accuracies);

}  // namespace cartvo::benchmark
