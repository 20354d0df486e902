#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/offset/offset_report.hpp"
#include "tools/benchmark/shutter/shutter_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// Errors as multiples of those of a global shutter on the same drive: the same scenario, right clock and
/// vibration. Nothing if that was not measured or one of them has no segments.
std::optional<ErrorRatios> ratiosToGlobal(const ShutterAccuracy& one,
                                          const std::vector<ShutterAccuracy>& all);

/// The summaries of all worlds for each case and model, with the sequence name "all N worlds". A case and
/// model with a single world has no summary.
std::vector<ShutterAccuracy> allWorlds(const std::vector<ShutterAccuracy>& accuracies);

/// Readouts as text: "32 ms", or "32 / 38 ms" if they differ.
std::string readoutName(const StereoReadout& readout);

/// The shutter table, text or Markdown: one row per accuracy, the summaries of all worlds, and a legend.
std::string shutterTable(const std::vector<ShutterAccuracy>& accuracies, ReportFormat format);

/// The same rows as JSON. Keys contain their unit; values that do not apply are null.
nlohmann::ordered_json shutterJson(const std::vector<ShutterAccuracy>& accuracies);

}  // namespace cartvo::benchmark
