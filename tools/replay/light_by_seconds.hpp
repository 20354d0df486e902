#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/diagnostics/light_monitor.hpp"

namespace cartvo {

/// Asks a LightMonitor after each second of a replay, as cartvod does: a lens may be covered for a part of a
/// drive.
class LightBySeconds {
 public:
  void add(const pipeline::PairResult& result, const odometry_t& message);
  bool hasTexture() const { return monitor_.hasTexture(); }

  /// Each problem in the order of its appearance: "left camera: the picture is dark: ... (5 of 8 s)". Call
  /// once, at the end.
  std::vector<std::string> consumeProblems();

 private:
  void endSecond();

  daemon::LightMonitor monitor_;
  std::optional<std::int64_t> begin_ns_;  ///< exposure of the second's first pair
  std::vector<std::pair<std::string, int>> problems_;
  int seconds_ = 0;
};

/// The self-check in the course of a drive: each fault with its last numbers and when it showed.
class DriveSelfCheck {
 public:
  /// Adds SelfCheck::message() after a pair, `seconds` after the first one.
  void add(const std::string& message, double seconds);
  /// The faults that lasted, the longest first, with their times unless they last to the end; empty if none.
  std::string sentence() const;

 private:
  struct Fault {
    std::string kind;  ///< the message without its numbers
    std::string message;
    double first, last;
    double lasted = 0.0;  ///< s
  };
  std::vector<Fault> faults_;
  double end_ = 0.0;
};

}  // namespace cartvo
