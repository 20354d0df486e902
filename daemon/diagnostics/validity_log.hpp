#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include <cartvo/odometry_t.hpp>

#include "daemon/diagnostics/line_budget.hpp"

namespace cartvo::daemon {

/// Logs when the odometry becomes valid or invalid. If that changes often, as on an overloaded host, the
/// first five changes get a line each, later ones share at most one line in ten seconds with their number.
/// Not thread-safe.
class ValidityLog {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns the line to log for one message, or empty. `bound_exceeded`: of this message, see
  /// LimitedBound::text(). Does not log, for tests; `log` does.
  std::string due(const odometry_t& message, const std::string& bound_exceeded, Clock::time_point now);
  void log(const odometry_t& message, const std::string& bound_exceeded);

  /// Validity of the last message; false before the first.
  bool isValid() const { return valid_; }

 private:
  bool valid_ = false;
  bool begun_ = false;
  std::uint64_t unlogged_changes_ = 0;
  LineBudget budget_;
  Clock::time_point last_logged_;
};

}  // namespace cartvo::daemon
