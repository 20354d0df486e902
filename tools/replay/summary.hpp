#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Summary of a replay as JSON: source, rig, estimator, pairs (valid, invalid by reason and by index),
/// dropped frames, processing times, path length, versions. `replay.pairs` must not be empty.
nlohmann::ordered_json replaySummary(const ReplaySettings& settings, const Replay& replay);

/// A line with the number of pairs that are not valid, by reason; empty if all are valid.
std::string invalidPairsText(const Replay& replay);

/// Why no pair is valid, by the most frequent reason, and what to look at. Empty if a pair is valid.
std::string nothingValidText(const Replay& replay);

}  // namespace cartvo
