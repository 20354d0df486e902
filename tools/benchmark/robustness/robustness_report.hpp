#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/robustness/robustness_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// A row per disturbance of each sequence, what the columns mean, and how many rows are worse than the thesis
/// or have wrong valid motions.
std::string robustnessTable(const std::vector<RobustnessRow>& rows, ReportFormat format);

nlohmann::ordered_json robustnessJson(const std::vector<RobustnessRow>& rows);

}  // namespace cartvo::benchmark
