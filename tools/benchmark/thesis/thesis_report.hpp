#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/benchmark/thesis/thesis_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The tables and figures of the thesis with the measured values and a legend each, text or Markdown.
std::string thesisTables(const ThesisResults& results, ReportFormat format);

/// The same values as JSON, with the counts of each image. The values of the thesis are under `thesis`, null
/// if unknown.
nlohmann::ordered_json thesisJson(const ThesisResults& results);

}  // namespace cartvo::benchmark
