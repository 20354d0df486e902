// Computes the summary of `cartvo watch` from the messages alone.
#include "tools/watch/odometry_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cartvo/client.hpp>

#include "common/statistics.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
// Startup time: pictures are delayed by one until the camera's packetisation is known.
constexpr std::int64_t kSettlingTime_ns = 2 * kSecond_ns;
constexpr double kMaxLatency_ms = 60'000.0;  // longer in no live pipeline; recordings exceed it

StampedPose pose(const odometry_t& message) {
  const double* q = message.orientation_world_body;
  StampedPose stamped;
  stamped.time_ns = message.utime * 1000;
  stamped.pose.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  stamped.pose.translation() = Eigen::Map<const Eigen::Vector3d>(message.position_world_body);
  return stamped;
}

/// Whether sums and differences of the message's integers cannot overflow: instants until the year 2100,
/// in ns too, and a count that is not negative.
bool hasPossibleNumbers(const odometry_t& message) {
  constexpr std::int64_t kLatest_us = 4'102'444'800'000'000;
  for (const std::int64_t instant : {message.utime, message.arrival_utime, message.publication_utime}) {
    if (instant < -kLatest_us || instant > kLatest_us) return false;
  }
  constexpr std::int64_t kMaxSequence = std::int64_t{1} << 53;
  return message.sequence >= 0 && message.sequence < kMaxSequence;
}

}  // namespace

bool isUsableWhenFresh(const odometry_t& message) {
  return client::isConsistent(message) && client::hasPossibleMotion(message);
}

std::optional<double> latencyMs(const odometry_t& message) {
  const double latency = static_cast<double>(message.publication_utime - message.arrival_utime) * 1e-3;
  return std::abs(latency) < kMaxLatency_ms ? std::optional(latency) : std::nullopt;
}

void OdometryStatistics::countMessage(const odometry_t& message) {
  ++counts_.messages;
  if (message.sequence <= last_sequence_) countRestart(message);
  if (last_sequence_ >= 0 && message.sequence > last_sequence_)
    counts_.lost += message.sequence - last_sequence_ - 1;
  if (message.sequence > last_sequence_ && message.reset_counter != last_reset_counter_ &&
      counts_.messages > 1) {
    ++counts_.resets;
  }
  last_sequence_ = message.sequence;
}

/// A daemon does not restart twice within two seconds: then two daemons publish alternately.
void OdometryStatistics::countRestart(const odometry_t& message) {
  constexpr std::int64_t kMinRunTime_us = 2'000'000;
  ++counts_.restarts;
  if (last_restart_utime_ && message.publication_utime - *last_restart_utime_ < kMinRunTime_us)
    counts_.two_publishers = true;
  last_restart_utime_ = message.publication_utime;
}

/// UDP can repeat and reorder messages; a restarted daemon publishes later than the one before.
bool OdometryStatistics::isLateOrRepeated(const odometry_t& message) const {
  constexpr std::int64_t kMaxDelay_us = 1'000'000;
  const std::int64_t delay = last_publication_utime_ - message.publication_utime;
  return message.sequence <= last_sequence_ && delay >= 0 && delay < kMaxDelay_us;
}

void OdometryStatistics::addMessage(const odometry_t& message, std::int64_t reception_ns) {
  if (!hasPossibleNumbers(message)) {
    ++counts_.senseless;
    return;
  }
  if (isLateOrRepeated(message)) return;
  countMessage(message);
  last_publication_utime_ = message.publication_utime;
  const bool same_epoch = last_was_valid_ && message.reset_counter == last_reset_counter_;
  last_reset_counter_ = message.reset_counter;
  last_was_valid_ = isUsableWhenFresh(message);
  if (message.status == odometry_t::VALID && !last_was_valid_) ++counts_.senseless;
  if (!isOfPair(message)) {
    ++counts_.no_pair;
    return;
  }
  receptions_ns_.push_back(reception_ns);
  if (const auto latency = latencyMs(message)) {
    latencies_ms_.push_back(*latency);
    if (reception_ns - receptions_ns_.front() >= kSettlingTime_ns) settled_latencies_ms_.push_back(*latency);
    ages_ms_.push_back(static_cast<double>(reception_ns - message.utime * 1000) * 1e-6);
  }
  offsets_ms_.push_back(static_cast<double>(message.offset_us) * 1e-3);
  if (!last_was_valid_) return;
  ++counts_.valid;
  const StampedPose stamped = pose(message);
  if (same_epoch && !trajectory_.empty()) {
    counts_.path_length += (stamped.pose.translation() - trajectory_.back().pose.translation()).norm();
  }
  trajectory_.push_back(stamped);
}

double OdometryStatistics::currentFrameRate(std::int64_t now_ns) const {
  const auto first = std::upper_bound(receptions_ns_.begin(), receptions_ns_.end(), now_ns - kSecond_ns);
  return static_cast<double>(receptions_ns_.end() - first);
}

OdometrySummary OdometryStatistics::summarise() const {
  OdometrySummary summary = counts_;
  if (receptions_ns_.size() > 1) {
    summary.seconds = static_cast<double>(receptions_ns_.back() - receptions_ns_.front()) * 1e-9;
    summary.frame_rate = static_cast<double>(receptions_ns_.size() - 1) / std::max(summary.seconds, 1e-9);
  }
  summary.latency_p50_ms = percentile(latencies_ms_, 0.5);
  summary.latency_p99_ms = percentile(latencies_ms_, 0.99);
  summary.latency_settled_p99_ms = percentile(settled_latencies_ms_, 0.99);
  summary.age_p50_ms = percentile(ages_ms_, 0.5);
  summary.age_p99_ms = percentile(ages_ms_, 0.99);
  summary.offset_median_ms = percentile(offsets_ms_, 0.5);
  return summary;
}

}  // namespace cartvo
