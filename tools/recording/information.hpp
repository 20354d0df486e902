#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "capture/recording/recording_summary.hpp"

namespace cartvo {

/// The summary as JSON: durations in s, timestamps in ns since the Unix epoch.
nlohmann::ordered_json informationJson(const capture::RecordingSummary& summary);

/// The summary as text: a few lines and a table with a column for each camera.
std::string informationText(const capture::RecordingSummary& summary);

}  // namespace cartvo
