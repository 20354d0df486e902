#pragma once

#include <array>
#include <chrono>

#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// Seconds that each stage of one pair took; a stage that ran more than once has the sum. Stages may be
/// nested or left out, so `total` is measured, not summed.
struct StageTimes {
  std::array<double, kStageCount> stages{};
  double total = 0.0;

  double of(Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
};

/// The clock that the observed stages are measured with.
class StageClock : public StageObserver {
 public:
  /// Forgets the pair before and starts its total.
  void startPair();
  void begin(Stage stage) override;
  void end(Stage stage) override;
  /// Ends the pair.
  StageTimes endPair();

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point pair_start_;
  std::array<Clock::time_point, kStageCount> starts_{};
  StageTimes times_;
};

}  // namespace cartvo
