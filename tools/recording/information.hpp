#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "capture/recording_summary.hpp"

namespace cartvo {

/// For programs: the summary with its times in s and its instants in ns since the Unix epoch.
nlohmann::ordered_json informationJson(const RecordingSummary& summary);

/// For people: a few lines, and a table with a column for each camera.
std::string informationText(const RecordingSummary& summary);

}  // namespace cartvo
