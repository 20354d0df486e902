#pragma once

#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// What a replay was and what came of it: source, rig, estimator, pairs (valid, invalid by reason and by
/// index), what became of the frames, times per pair, path length, versions.
nlohmann::ordered_json replaySummary(const ReplaySettings& settings, const Replay& replay);

}  // namespace cartvo
