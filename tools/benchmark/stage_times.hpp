#pragma once

#include <array>

#include <opencv2/core/types.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo::benchmark {

/// Medians over the pairs of a replay, the first aside, ms: the thesis' Table 5-2.
struct StageMedians {
  std::array<double, kStageCount> stages{};
  double total = 0.0;

  double of(Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
};

/// The replay must hold two pairs.
StageMedians stageMedians(const Replay& replay);

/// Rectification of a pair of `size` by tables, ms, median of some runs: for sequences that come rectified.
/// What the images show does not matter to it.
double rectificationMs(cv::Size size);

}  // namespace cartvo::benchmark
