#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy/accuracy.hpp"
#include "tools/benchmark/world_sets.hpp"

namespace cartvo::benchmark {

/// A value and the world that has it.
struct WorldValue {
  double value = 0.0;
  std::string world;
};

/// Errors of one estimator on the lossless worlds of one set.
struct SetSummary {
  std::string estimator;
  std::optional<WorldSet> set;  ///< nothing: worlds of neither set
  std::vector<SequenceAccuracy> worlds;

  /// Translation errors over segments of 5 to 40 m, as fractions; nothing if no world has segments.
  std::optional<double> segment_mean;  ///< geometric mean of the worlds
  std::optional<WorldValue> segment_worst;
  std::optional<WorldValue> nees_lowest, nees_highest;  ///< of motions
  std::size_t invalid = 0;                              ///< pairs
  ValidityFigures validity;                             ///< of all messages
};

/// One summary per estimator and set, in order of first occurrence.
std::vector<SetSummary> setSummaries(const std::vector<SequenceAccuracy>& accuracies);

/// "tuning", "reporting" or "neither".
std::string setName(const std::optional<WorldSet>& set);

/// A line of text.
std::string summaryLine(const SetSummary& summary);

nlohmann::ordered_json setSummaryJson(const SetSummary& summary);

}  // namespace cartvo::benchmark
