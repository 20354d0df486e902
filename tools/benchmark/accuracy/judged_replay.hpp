#pragma once

#include <vector>

#include "tools/benchmark/sequence.hpp"
#include "tools/evaluate/validity/judged_messages.hpp"
#include "tools/replay/replay.hpp"

namespace cartvo::benchmark {

/// The published messages of a replay, judged by the truth at their exposures. The true twist of a rendered
/// world is exact; that of a real sequence comes from its poses, see TrueTwist.
std::vector<JudgedMessage> judge(const Replay& replay, const SequenceTruth& truth);

}  // namespace cartvo::benchmark
