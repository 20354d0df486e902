#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "pipeline/pair_processor.hpp"

// Answers of /metrics, /healthz and /readyz, without the server.

namespace cartvo::daemon {

/// Upper bounds of the latency histogram, s: last packet to publication.
constexpr std::array<double, 7> kLatencyBounds{0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5};

/// Sums over all processed pairs since the start, and the bounds of the last one. Times in s.
struct PairTotals {
  std::uint64_t pairs = 0;
  std::array<double, vo::kStageCount> stages{};  ///< by vo::Stage
  double process = 0.0;                          ///< rectification and odometry
  double queue = 0.0;                            ///< decoded until processing begins
  std::array<double, 2> decode{};                ///< last packet until decoded, left and right
  double latency = 0.0;
  std::array<std::uint64_t, kLatencyBounds.size()> latency_counts{};  ///< of pairs up to each bound

  std::uint64_t above_alert_limit = 0;  ///< pairs
  pipeline::ProtectionLevel level;
  std::int8_t quality = 0;

  void add(const pipeline::PairResult& result, const odometry_t& message);
};

/// Text format 0.0.4 of Prometheus: each number of health_t under its name with the prefix cartvo_ (of a
/// camera cartvo_camera_, with the label camera), and the totals. Contains no texts beside the version.
std::string metricsText(const health_t& health, const PairTotals& totals);

/// The values that decide whether the daemon is healthy.
struct DaemonState {
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_message;  ///< when an odometry message was published; at first the start
  Clock::time_point last_valid;    ///< when a VALID one was
  std::int32_t reasons = 0;        ///< of the last message
  std::string stalled;             ///< as PipelineProgress::stalledReader()
  health_t health{};               ///< the last one published

  /// Time since the last message, s, if it is longer than a daemon that works ever takes.
  std::optional<double> silence(Clock::time_point now) const {
    constexpr double kLongest = 3.0;
    const double seconds = std::chrono::duration<double>(now - last_message).count();
    return seconds > kLongest ? std::optional(seconds) : std::nullopt;
  }
};

struct HealthAnswer {
  bool is_healthy = false;
  std::string line;
};

/// Healthy: odometry is valid (within the last second), or the daemon waits for a camera. Not healthy: a
/// stage is stalled, a camera refuses the login, or both cameras stream but odometry is invalid.
HealthAnswer healthAnswer(const DaemonState& state, DaemonState::Clock::time_point now);

/// Ready: healthy, and both cameras stream.
HealthAnswer readyAnswer(const DaemonState& state, DaemonState::Clock::time_point now);

}  // namespace cartvo::daemon
