#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "capture/camera_source.hpp"
#include "capture/pair_clock.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/self_check.hpp"

namespace cartvo {

/// What the daemon's other parts say at the moment a health message is made.
struct HealthSnapshot {
  CameraHealth left;
  CameraHealth right;
  PipelineCounts counts;
  ClockStatus clock;
  std::string problem;    ///< what a person should mend first; empty: see the cameras' last errors
  int features = 0;       ///< as configured
  std::string recording;  ///< why nothing is recorded that should be; the least of the problems
};

/// Gathers what happened since the last health message. One thread.
class HealthMonitor {
 public:
  using Clock = std::chrono::steady_clock;

  explicit HealthMonitor(Clock::time_point start);

  /// A pair was processed and published as `message`.
  void add(const PairResult& result, const odometry_t& message);
  /// A message was published for a pair that did not come.
  void addNoPair();

  /// Makes the message for the time since the last one and begins anew.
  health_t summarise(Clock::time_point now, const HealthSnapshot& snapshot);

  SelfCheck& selfCheck() { return self_check_; }

 private:
  /// Of the pairs since the last message, ms.
  struct Window {
    int features = std::numeric_limits<int>::max();  // the least that were aimed at
    std::vector<double> latency, process, offset, left_decode, right_decode;
  };

  Clock::time_point start_;
  Clock::time_point last_;
  Window window_;
  std::int64_t valid_ = 0;
  std::int64_t invalid_ = 0;
  std::uint64_t last_left_frames_ = 0;
  std::uint64_t last_right_frames_ = 0;
  std::uint64_t last_pairs_ = 0;
  SelfCheck self_check_;
};

/// The value below which `fraction` of the values lie (nearest rank); NaN if there are none.
double percentile(std::vector<double> values, double fraction);

}  // namespace cartvo
