#pragma once

#include <filesystem>
#include <string>

#include <cartvo/health_t.hpp>

#include "tools/watch/odometry_statistics.hpp"

namespace cartvo {

struct WatchSettings {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  double seconds = 0.0;         ///< to watch from the first message on; 0: until SIGINT or SIGTERM
  double until_silent = 0.0;    ///< ends when no pair was heard of for so long, s; 0: goes on
  double first_message = 15.0;  ///< s to wait for the first message
  bool plain = false;           ///< a line a second instead of one line that is drawn over
};

/// Listens to CARTVO_ODOMETRY, prints a live line to standard output, and returns what was heard. Throws
/// std::runtime_error, saying what may be wrong, if nothing comes at first.
OdometryStatistics watchOdometry(const WatchSettings& settings);

/// The live line: "18.0 fps  latency 7.9 ms  speed 3.21 m/s  yaw -2.1 deg/s  features 987  offset +0.4 ms
/// valid".
std::string liveLine(const odometry_t& message, double frame_rate);

/// What the daemon says should be mended, a line for each; empty if all is well.
std::string adviceText(const health_t& message);

/// "by sender reports ±0.7 ms": what relates the two cameras' exposures, and how well.
std::string clockText(const health_t& message);

/// The summary for people, some lines.
std::string summaryText(const OdometrySummary& summary);

/// The summary as JSON; numbers that are not known are null.
void writeSummary(const std::filesystem::path& file, const OdometrySummary& summary);

}  // namespace cartvo
