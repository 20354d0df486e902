#pragma once

#include <string>

#include <cartvo/health_t.hpp>

#include "daemon/publish/lcm_url.hpp"
#include "tools/watch/odometry_statistics.hpp"

namespace cartvo {

/// Settings of `cartvo watch`.
struct WatchSettings {
  std::string url = daemon::defaultLcmUrl();
  double seconds = 0.0;          ///< s, end this long after the first message; 0: at SIGINT or SIGTERM
  double until_silent = 0.0;     ///< s, end after this time without a pair; 0: never
  double first_message = 15.0;   ///< s, time limit for the first message
  bool plain = false;            ///< print one line per second instead of redrawing one
  bool to_error_output = false;  ///< print lines to standard error
};

/// Receives CARTVO_ODOMETRY, prints a live line to standard output and returns the statistics. Throws
/// std::runtime_error with possible causes if no first message arrives.
OdometryStatistics watchOdometry(const WatchSettings& settings);

/// Formats the live line: "18.0 fps  latency 7.9 ms  speed 3.21 m/s  yaw -2.1 deg/s  features 987  offset
/// +0.4 ms  valid  by sender reports ±0.7 ms". `clocks`: clockText, or empty. To fit into `columns`,
/// features, clocks, offset, latency and yaw are left out in this order. `bound_exceeded`: of health_t, or
/// empty; said with a message that is INVALID for it.
std::string liveLine(const odometry_t& message, double frame_rate, const std::string& clocks = {},
                     std::size_t columns = 1000, const std::string& bound_exceeded = {});

/// The reasons of an INVALID message; of a bound above its alert limit with what `bound_exceeded` says.
std::string invalidText(const odometry_t& message, const std::string& bound_exceeded);

/// Advice if messages of these channels cannot be decoded; empty if all can.
std::string foreignDefinitionText(bool odometry, bool health);

/// The problem and the self-check of a health message, one line each; empty if there is none.
std::string adviceText(const health_t& message);

/// Source and standard deviation of the time offset, such as "by sender reports ±0.7 ms".
std::string clockText(const health_t& message);

/// The summary as text of several lines.
std::string summaryText(const OdometrySummary& summary);

/// The summary as JSON; NaN becomes null.
std::string summaryJson(const OdometrySummary& summary);

/// Share of the pairs whose message was valid, %; 0 without pairs.
double validPercent(const OdometrySummary& summary);

}  // namespace cartvo
