#pragma once

#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// The name that the command line and the configuration know an estimator by.
const char* estimatorName(Estimator estimator);

/// What a replay was and what came of it: source, rig, estimator, pairs (valid, invalid by reason and by
/// index), what became of the frames, times per pair, path length, versions.
nlohmann::ordered_json replaySummary(const ReplaySettings& settings, const Replay& replay);

}  // namespace cartvo
