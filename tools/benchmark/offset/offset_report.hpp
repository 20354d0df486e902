#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/error_ratios.hpp"
#include "tools/benchmark/offset/offset_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// The ratios of `one` to its reference in `all`, two-instants on the same sequence without a time offset;
/// nothing if the reference is missing or has no segments.
std::optional<ErrorRatios> ratiosOf(const OffsetAccuracy& one, const std::vector<OffsetAccuracy>& all);

/// The summaries of all worlds for each clock and model, with the sequence name "all N worlds". A clock and
/// model with a single world has no summary.
std::vector<OffsetAccuracy> allWorlds(const std::vector<OffsetAccuracy>& accuracies);

/// The clock as text: "25 ms", or "27.5 ms +50 ppm" if it drifts.
std::string clockName(const RightClock& clock);

/// The offset table, text or Markdown: one row per accuracy, the summaries of all worlds, and a legend.
std::string offsetTable(const std::vector<OffsetAccuracy>& accuracies, ReportFormat format);

/// The same rows as JSON. Keys contain their unit; values that do not apply are null.
nlohmann::ordered_json offsetJson(const std::vector<OffsetAccuracy>& accuracies);

}  // namespace cartvo::benchmark
