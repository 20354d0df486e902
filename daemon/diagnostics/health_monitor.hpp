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
#include "capture/clock/stereo_timestamper.hpp"
#include "daemon/diagnostics/light_monitor.hpp"
#include "daemon/diagnostics/self_check.hpp"
#include "pipeline/pipeline.hpp"

// Statistics for the periodic health message.

namespace cartvo::daemon {

/// State of the daemon's other parts when a health message is built.
struct HealthSnapshot {
  capture::CameraHealth left;
  capture::CameraHealth right;
  pipeline::PipelineCounts counts;
  capture::ClockStatus clock;
  std::string problem;     ///< the problem to fix first; empty: see the cameras' last errors
  int features = 0;        ///< as configured
  std::string recording;   ///< why a configured recording is not written; named while the odometry is VALID
  std::string pairing;     ///< as Pipeline::pairingProblem(); after the clocks
  std::string frame_rate;  ///< as frameRateProblem(); after that
  std::string advice;      ///< said in self_check while that has no fault
};

/// Accumulates statistics between health messages. Not thread-safe.
class HealthMonitor {
 public:
  using Clock = std::chrono::steady_clock;

  /// `readouts`: of the rig file or the configuration.
  explicit HealthMonitor(Clock::time_point start, const StatedReadouts& readouts = {});

  /// Adds a processed pair, published as `message`.
  void addPair(const pipeline::PairResult& result, const odometry_t& message);
  /// Counts a message published for a pair that did not arrive.
  void addMissedPair();

  /// Builds the message for the time since the previous one and resets the statistics.
  health_t summarise(Clock::time_point now, const HealthSnapshot& snapshot);

  /// LightMonitor::consumeProblem(), as of the last message.
  const std::string& lightProblem() const { return light_problem_; }

  SelfCheck& selfCheck() { return self_check_; }

 private:
  /// Statistics of the pairs since the last message.
  struct Window {
    int least_features = std::numeric_limits<int>::max(), most_features = 0;  // target numbers
    vo::IntegrityState state = vo::IntegrityState::lost;                      // after the last pair
    std::optional<pipeline::LimitedBound> worst;  // of the pairs above an alert limit
    std::vector<double> latency, process, offset, left_decode, right_decode;  // ms
  };

  Clock::time_point start_;
  Clock::time_point last_;
  Window window_;
  Clock::time_point last_all_features_;  // last message with a pair of all features, or with none
  std::int64_t valid_ = 0, last_valid_ = 0;
  std::int64_t invalid_ = 0, last_invalid_ = 0;
  std::uint64_t last_left_frames_ = 0;
  std::uint64_t last_right_frames_ = 0;
  std::uint64_t last_pairs_ = 0;
  SelfCheck self_check_;
  LightMonitor light_;
  std::string light_problem_;
};

}  // namespace cartvo::daemon
