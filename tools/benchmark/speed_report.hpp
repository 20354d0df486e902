#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/speed_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// A row for each result; the stages; the reference; how time grows with features and pixels. Not for JSON.
std::string speedTables(const std::vector<SpeedResult>& results, ReportFormat format);

/// {"speeds": [...]}.
nlohmann::ordered_json speedJson(const std::vector<SpeedResult>& results);

}  // namespace cartvo::benchmark
