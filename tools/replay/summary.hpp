#pragma once

#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Summary of a replay as JSON: source, rig, estimator, pairs (valid, invalid by reason and by index),
/// dropped frames, processing times, path length, versions. `replay.pairs` must not be empty.
nlohmann::ordered_json replaySummary(const ReplaySettings& settings, const Replay& replay);

}  // namespace cartvo
