#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/evaluate/evaluation.hpp"

namespace cartvo {

/// Text table of the evaluation, in metres, percent and degrees.
std::string evaluationTable(const Evaluation& evaluation);

/// JSON of the evaluation; each key names its unit. Values that do not apply are null.
nlohmann::ordered_json evaluationJson(const Evaluation& evaluation);

}  // namespace cartvo
