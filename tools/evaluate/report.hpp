#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/evaluate/evaluation.hpp"

namespace cartvo {

/// A table for people: metres, percent, degrees.
std::string evaluationTable(const Evaluation& evaluation);

/// The same for programs; each key carries its unit. What does not apply is null.
nlohmann::ordered_json evaluationJson(const Evaluation& evaluation);

}  // namespace cartvo
