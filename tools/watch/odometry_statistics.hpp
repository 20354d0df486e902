#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <cartvo/odometry_t.hpp>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// Latency from the last packet to publication, ms; none for a replayed recording, whose packets are older
/// than the publication by more than a minute.
std::optional<double> latencyMs(const odometry_t& message);

/// Whether the message is of a pair: not of one that is missing.
inline bool isOfPair(const odometry_t& message) {
  return (message.reasons & odometry_t::REASON_NO_PAIR) == 0;
}

/// Whether a controller could use the message while it is fresh: VALID, with possible numbers and no reason
/// against it.
bool isUsableWhenFresh(const odometry_t& message);

/// Summary of the received CARTVO_ODOMETRY messages. Latency and age are NaN if all of them replay a
/// recording.
struct OdometrySummary {
  std::int64_t messages = 0;
  std::int64_t lost = 0;       ///< missing sequence numbers
  std::int64_t no_pair = 0;    ///< messages without a stereo pair
  std::int64_t senseless = 0;  ///< messages whose numbers are not possible, or VALID with a reason against it
  std::int64_t valid = 0;
  std::int64_t restarts = 0;    ///< restarts of the daemon: the sequence number decreased
  bool two_publishers = false;  ///< the sequence numbers of two daemons alternated
  std::int64_t resets = 0;      ///< resets of the pose: the reset counter changed
  double seconds = 0.0;         ///< s, from the first to the last message with a pair
  double frame_rate = 0.0;      ///< pairs per second over that time
  double path_length = 0.0;     ///< m, over valid poses between resets
  double latency_p50_ms = 0.0, latency_p99_ms = 0.0;  ///< from last packet to publication
  double latency_settled_p99_ms = 0.0;                ///< the same without the first 2 s; NaN: none
  double age_p50_ms = 0.0, age_p99_ms = 0.0;          ///< from exposure to reception, by both clocks
  double offset_median_ms = 0.0;                      ///< right minus left exposure
};

/// Accumulates statistics of messages in their order of arrival. Ignores messages that come again or late.
/// Memory grows by about 100 bytes per message.
class OdometryStatistics {
 public:
  /// `reception_ns`: system time of reception, ns since the Unix epoch.
  void addMessage(const odometry_t& message, std::int64_t reception_ns);

  OdometrySummary summarise() const;

  /// The numbers of messages and the path length so far; rates and percentiles are not computed.
  const OdometrySummary& counts() const { return counts_; }

  /// Whether two daemons publish, see OdometrySummary.
  bool hasTwoPublishers() const { return counts_.two_publishers; }

  /// Whether any message was of a stereo pair.
  bool hasPairs() const { return !receptions_ns_.empty(); }

  /// T_world_body of the valid messages.
  const Trajectory& trajectory() const { return trajectory_; }

  /// Number of pairs received in the second before `now_ns`.
  double currentFrameRate(std::int64_t now_ns) const;

 private:
  void countMessage(const odometry_t& message);
  void countRestart(const odometry_t& message);
  bool isLateOrRepeated(const odometry_t& message) const;

  OdometrySummary counts_;
  Trajectory trajectory_;
  std::vector<std::int64_t> receptions_ns_;  ///< of messages with a pair
  std::vector<double> latencies_ms_, settled_latencies_ms_, ages_ms_, offsets_ms_;
  std::int64_t last_sequence_ = -1, last_publication_utime_ = 0;
  std::optional<std::int64_t> last_restart_utime_;  ///< publication of the first message after the last one
  std::int32_t last_reset_counter_ = 0;
  bool last_was_valid_ = false;
};

}  // namespace cartvo
