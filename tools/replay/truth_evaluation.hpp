#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// How a replay agrees with the truth, as `cartvo evaluate` computes it.
struct TruthEvaluation {  // NOLINT(bugprone-exception-escape): moving a JSON value throws nothing
  nlohmann::ordered_json evaluation, consistency;  ///< of summary.json; each key names its unit
  std::vector<std::string> errors;                 ///< for motionCsv
  std::string table;                               ///< for the terminal
};

/// Checks that cartvo-evaluate can read the truth of a replay. Throws std::runtime_error if it cannot; the
/// program prints the reason.
void checkTruth(const std::filesystem::path& truth);

/// Runs cartvo-evaluate, which is beside this program, with the truth of a replay: KITTI rows are poses of
/// the left camera, one per pair; rows of TUM and EuRoC are poses of the body, interpolated at each pair's
/// instant, as are those of a raw recording of KITTI (`truth` is its folder). Throws
/// std::runtime_error if that fails; the program prints the reason.
TruthEvaluation evaluateWithTruth(const Replay& replay, const std::filesystem::path& truth);

}  // namespace cartvo
