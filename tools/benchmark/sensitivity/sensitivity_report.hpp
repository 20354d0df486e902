#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/benchmark/sensitivity/sensitivity_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The lists of vo::tunedConstants() and vo::productLimits() with units, defaults, ranges and sources, text
/// or Markdown.
std::string constantsTable(ReportFormat format);
nlohmann::ordered_json constantsJson();

/// The changes by each constant, text or Markdown.
std::string sensitivityTable(const Sensitivity& sensitivity, ReportFormat format);
nlohmann::ordered_json sensitivityJson(const Sensitivity& sensitivity);

}  // namespace cartvo::benchmark
