#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/offset/offset_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// Errors as multiples of those of two-instants on the same sequence without a time offset.
struct ErrorRatios {
  double segment_translation = 0.0, segment_rotation = 0.0;    ///< 5 to 40 m
  double relative_translation = 0.0, relative_rotation = 0.0;  ///< from pair to pair

  double largest() const;
};

/// The ratios of the errors of `one` to those of `reference`; nothing if one of them has no segments.
std::optional<ErrorRatios> ratiosOf(const Evaluation& one, const Evaluation& reference);

/// The ratios of `one` to its reference in `all`; nothing if the reference is missing or has no segments.
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
