#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/offset_benchmark.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {

/// Errors as multiples of those that two-instants makes of the same sequence with cameras exposed at once.
struct ErrorRatios {
  double segment_translation = 0.0, segment_rotation = 0.0;    ///< 5 to 40 m
  double relative_translation = 0.0, relative_rotation = 0.0;  ///< from pair to pair

  double largest() const;
};

/// Nothing where there is nothing to compare with, or no segment.
std::optional<ErrorRatios> ratiosOf(const OffsetAccuracy& one, const std::vector<OffsetAccuracy>& all);

/// The worlds of each clock and model together, with the sequence "all N worlds"; nothing if there is but
/// one.
std::vector<OffsetAccuracy> allWorlds(const std::vector<OffsetAccuracy>& accuracies);

/// "25 ms", or "27.5 ms + 50 ppm" where the right camera's clock drifts.
std::string clockName(const RightClock& clock);

/// A row for each accuracy, then those of all worlds together, and what the columns mean. Text or Markdown.
std::string offsetTable(const std::vector<OffsetAccuracy>& accuracies, ReportFormat format);

/// The same for programs; each key carries its unit. What does not apply is null.
nlohmann::ordered_json offsetJson(const std::vector<OffsetAccuracy>& accuracies);

}  // namespace cartvo::benchmark
