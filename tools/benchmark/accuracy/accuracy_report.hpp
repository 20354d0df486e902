#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy/accuracy.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The accuracy table, text or Markdown: one row per accuracy, one summary row per estimator over all
/// rendered worlds (lossless), a legend, and a table of accuracy over bit rate if there are encoded runs.
std::string accuracyTable(const std::vector<SequenceAccuracy>& accuracies, ReportFormat format);

/// The accuracies as JSON: `sequences` and `summaries` (same form) and `bitrates`. Keys contain their unit;
/// values that do not apply are null.
nlohmann::ordered_json accuracyJson(const std::vector<SequenceAccuracy>& accuracies);

}  // namespace cartvo::benchmark
