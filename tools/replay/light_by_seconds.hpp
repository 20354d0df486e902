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

}  // namespace cartvo
