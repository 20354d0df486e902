#pragma once

#include <array>

#include <opencv2/core/types.hpp>

#include "tools/replay/replay.hpp"

namespace cartvo::benchmark {

/// Median stage times over the pairs of a replay except the first, ms: Table 5-2 of the thesis.
struct StageMedians {
  std::array<double, vo::kStageCount> stages{};
  double total = 0.0;

  double stage(vo::Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
};

/// Requires a replay of at least two pairs.
StageMedians stageMedians(const Replay& replay);

/// Median time to rectify a pair of `size` by lookup tables, ms, for sequences whose images are already
/// rectified. The time does not depend on the image content.
double rectificationMs(cv::Size size);

}  // namespace cartvo::benchmark
