#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/speed/speed_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The tables of times, stages, reference work, and growth of time with features and pixels. `format` must
/// not be JSON.
std::string speedTables(const std::vector<SpeedResult>& results, ReportFormat format);

/// The results as JSON: {"speeds": [...]}.
nlohmann::ordered_json speedJson(const std::vector<SpeedResult>& results);

}  // namespace cartvo::benchmark
