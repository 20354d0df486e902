#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/evaluate/consistency.hpp"
#include "tools/evaluate/evaluation.hpp"

// Common parts of the reports of errors over time offsets and over readouts.

namespace cartvo::benchmark {

/// Errors as multiples of those of a reference on the same sequence.
struct ErrorRatios {
  double segment_translation = 0.0, segment_rotation = 0.0;    ///< 5 to 40 m
  double relative_translation = 0.0, relative_rotation = 0.0;  ///< from pair to pair

  double largest() const;
};

/// The ratios of the errors of `one` to those of `reference`; nothing if one of them has no segments.
std::optional<ErrorRatios> ratiosOf(const Evaluation& one, const Evaluation& reference);

/// The ratios with their names as keys; null if there are none.
nlohmann::ordered_json ratiosJson(const std::optional<ErrorRatios>& ratios);

/// Cells of a table: errors of segments of 5 to 40 m ("% / deg/m") and from pair to pair ("mm / deg"), and
/// their ratios.
struct ErrorCells {
  std::string segments, segment_ratios, relative, relative_ratios;
};
ErrorCells errorCells(const Evaluation& evaluation, const std::optional<ErrorRatios>& ratios);

/// The mean NEES as a cell of a table and as JSON; null if there are no errors.
std::string neesCell(const NormalisedErrors& errors);
nlohmann::ordered_json neesJson(const NormalisedErrors& errors);

/// The evaluation as JSON; values that are not defined for several drives together are null.
nlohmann::ordered_json evaluationOfDrivesJson(const Evaluation& evaluation);

}  // namespace cartvo::benchmark
