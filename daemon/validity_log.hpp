#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include <cartvo/odometry_t.hpp>

#include "daemon/line_budget.hpp"

namespace cartvo {

/// Tells when the odometry becomes valid or stops to be. Where that changes again and again, as on a host
/// that is too slow, only the first few changes are told each by a line, then at most one line in ten seconds
/// with their number. One thread.
class ValidityLog {
 public:
  using Clock = std::chrono::steady_clock;

  /// For each message: the line to log now, or empty. Pure, for tests; `note` logs it.
  std::string due(const odometry_t& message, Clock::time_point now);
  void note(const odometry_t& message);

  /// Of the last message; false before the first.
  bool valid() const { return valid_; }

 private:
  bool valid_ = false;
  bool begun_ = false;
  std::uint64_t untold_changes_ = 0;
  LineBudget budget_;
  Clock::time_point last_told_;
};

}  // namespace cartvo
