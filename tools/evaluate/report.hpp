#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/validity/validity_figures.hpp"

namespace cartvo {

/// Text table of the evaluation, in metres, percent and degrees.
std::string evaluationTable(const Evaluation& evaluation);

/// Lines about the VALID messages, in the form of evaluationTable.
std::string validityTable(const ValidityFigures& figures, const pipeline::AlertLimits& limits);

/// JSON of the evaluation; each key names its unit. Values that do not apply are null.
nlohmann::ordered_json evaluationJson(const Evaluation& evaluation);

}  // namespace cartvo
