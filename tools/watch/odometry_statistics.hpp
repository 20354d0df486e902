#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <cartvo/odometry_t.hpp>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// From the last packet to publication, ms; none for a recording that is replayed: its packets came long ago.
std::optional<double> latencyMs(const odometry_t& message);

/// What was heard on CARTVO_ODOMETRY. Latency and age are NaN if all of it was a recording.
struct OdometrySummary {
  std::int64_t messages = 0;
  std::int64_t lost = 0;     ///< gaps in the sequence
  std::int64_t no_pair = 0;  ///< messages for pairs that did not come
  std::int64_t valid = 0;
  std::int64_t restarts = 0;                          ///< of the daemon: the sequence began anew
  std::int64_t resets = 0;                            ///< of the pose: the reset counter grew
  double seconds = 0.0;                               ///< from the first message of a pair to the last
  double frame_rate = 0.0;                            ///< pairs a second over that time, Hz
  double path_length = 0.0;                           ///< m, over valid poses within an epoch
  double latency_p50_ms = 0.0, latency_p99_ms = 0.0;  ///< last packet to publication
  double latency_settled_p99_ms = 0.0;        ///< of those 2 s after the first pair and later; NaN: none
  double age_p50_ms = 0.0, age_p99_ms = 0.0;  ///< exposure to reception, by both clocks
  double offset_median_ms = 0.0;              ///< right minus left exposure
};

/// Gathers messages in the order they arrive. Memory grows by about 100 bytes a message.
class OdometryStatistics {
 public:
  void add(const odometry_t& message, std::int64_t reception_ns);

  OdometrySummary summarise() const;

  /// Whether a message stemmed from a pair of frames.
  bool hasPairs() const { return !receptions_ns_.empty(); }

  /// T_world_body of the valid messages.
  const Trajectory& trajectory() const { return trajectory_; }

  /// Pairs a second over the last second before `now_ns`, Hz.
  double currentFrameRate(std::int64_t now_ns) const;

 private:
  void count(const odometry_t& message);

  OdometrySummary counts_;
  Trajectory trajectory_;
  std::vector<std::int64_t> receptions_ns_;  ///< of messages that stem from a pair
  std::vector<double> latencies_ms_, settled_latencies_ms_, ages_ms_, offsets_ms_;
  std::int64_t last_sequence_ = -1;
  std::int32_t last_reset_counter_ = 0;
  bool last_was_valid_ = false;
};

}  // namespace cartvo
