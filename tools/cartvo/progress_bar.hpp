#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "tools/cartvo/work_observer.hpp"

namespace cartvo {

/// The progress line in at most `columns`: the bar becomes shorter first, then rate, remaining time and bar
/// are left out. `expected`: 0 if unknown. `seconds`: since the start. With the unit "s" there is no rate.
std::string progressLine(std::size_t done, std::size_t expected, const std::string& unit, double seconds,
                         std::size_t columns);

/// Progress line on standard error with count, rate and remaining time. On a terminal it is redrawn in place
/// and erased at the end. Otherwise a line is printed every ten seconds, or every $CARTVO_PROGRESS_INTERVAL
/// seconds, and one at the end if there was one before.
class ProgressBar {
 public:
  /// `unit`: name of the counted things, plural.
  explicit ProgressBar(std::string unit);
  /// Shows the name of the step at once: on a terminal before the bar, otherwise on a line of its own.
  explicit ProgressBar(WorkStep step);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `expected`: total number; 0 if unknown. Limits its output rate itself.
  void show(std::size_t done, std::size_t expected);

 private:
  using Clock = std::chrono::steady_clock;

  /// Replaces the line on a terminal; prints a line otherwise.
  void draw(const std::string& line);

  WorkStep step_;
  bool is_terminal_;
  Clock::duration pause_;  ///< between lines
  bool drawn_ = false, shown_ = false, ended_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_shown_ = start_;
};

}  // namespace cartvo
