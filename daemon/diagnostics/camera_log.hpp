#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/common.h>

#include "capture/camera_source.hpp"
#include "daemon/diagnostics/line_budget.hpp"
#include "daemon/diagnostics/log.hpp"

namespace cartvo::daemon {

/// Logs the health of one camera, which is polled: each change of its state; its fault, repeated each minute
/// while it lasts; and faults that began and ended between two polls, in a bounded number of lines. Not
/// thread-safe.
class CameraLog {
 public:
  using Clock = std::chrono::steady_clock;

  struct Line {
    spdlog::level::level_enum level = spdlog::level::info;
    std::string text;
    bool operator==(const Line&) const = default;
  };

  /// `name` begins each line, for example "left camera".
  explicit CameraLog(std::string name) : name_(std::move(name)) {}

  /// Returns the lines to log for one poll. Does not log, for tests; `log` does.
  std::vector<Line> due(const capture::CameraHealth& health, Clock::time_point now);
  void log(const capture::CameraHealth& health);

 private:
  void addStateLine(const capture::CameraHealth& health, bool changed, Clock::time_point now,
                    std::vector<Line>& lines);
  void addMissedFaultLine(const capture::CameraHealth& health, Clock::time_point now,
                          std::vector<Line>& lines);

  std::string name_;
  std::optional<capture::CameraState> state_;  ///< at the last poll
  std::uint64_t reconnections_ = 0;            ///< at the last poll
  std::uint64_t unlogged_reconnections_ = 0;   ///< not yet mentioned in any line
  RepeatedWarnings faults_;
  LineBudget budget_;
};

}  // namespace cartvo::daemon
