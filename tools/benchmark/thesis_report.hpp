#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/benchmark/thesis_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The thesis' tables and figures beside what was measured here, each with what it measures. Text or
/// Markdown.
std::string thesisTables(const ThesisResults& results, ReportFormat format);

/// The same for programs, with the counts of each image; the thesis' values under `thesis`, null where they
/// are not known.
nlohmann::ordered_json thesisJson(const ThesisResults& results);

}  // namespace cartvo::benchmark
