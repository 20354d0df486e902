#pragma once

#include <array>
#include <chrono>

#include "vo_core/stereo_odometry.hpp"

namespace cartvo::pipeline {

/// Processing time of each stage of one pair, s, summed if a stage ran more than once. `total` is measured,
/// not summed, because stages may be nested or skipped.
struct StageTimes {
  std::array<double, vo::kStageCount> stages{};
  double total = 0.0;

  double stage(vo::Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
};

/// Measures the stages that the odometry reports.
class StageClock : public vo::StageObserver {
 public:
  /// Discards the previous pair's times and starts `total`.
  void startPair();
  void begin(vo::Stage stage) override;
  void end(vo::Stage stage) override;
  /// Stops `total` and returns the times.
  StageTimes endPair();

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point pair_start_;
  std::array<Clock::time_point, vo::kStageCount> starts_{};
  StageTimes times_;
};

}  // namespace cartvo::pipeline
