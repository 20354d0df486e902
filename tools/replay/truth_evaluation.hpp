#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"
#include "tools/replay/truth.hpp"

namespace cartvo {

/// How a replay agrees with the truth, as `cartvo evaluate` computes it.
struct TruthEvaluation {
  nlohmann::ordered_json evaluation, consistency;  ///< of summary.json; each key names its unit
  std::string table;                               ///< for the terminal
};

/// The input of `cartvo-evaluate --of-replay`, which tools/evaluate/evaluation/of_replay.py describes.
/// `truth` is from `file`, see readTruth.
nlohmann::json evaluationInput(const Replay& replay, const Truth& truth, const std::filesystem::path& file);

/// Runs cartvo-evaluate, which is beside this program. Throws std::runtime_error if that fails; it says the
/// reason itself.
TruthEvaluation evaluateWithTruth(const Replay& replay, const Truth& truth,
                                  const std::filesystem::path& file);

}  // namespace cartvo
