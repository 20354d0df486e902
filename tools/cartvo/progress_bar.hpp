#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace cartvo {

/// The progress line in at most `columns`: the bar becomes shorter first, then rate, remaining time and bar
/// are left out. `expected`: 0 if unknown. `seconds`: since the start.
std::string progressLine(std::size_t done, std::size_t expected, const std::string& unit, double seconds,
                         std::size_t columns);

/// Progress line on standard error with count, rate and remaining time. On a terminal it is redrawn in place
/// and erased at the end; otherwise a line is printed every ten seconds, and one at the end.
class ProgressBar {
 public:
  /// `unit`: name of the counted things, plural.
  explicit ProgressBar(std::string unit);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `expected`: total number; 0 if unknown. Limits its output rate itself.
  void show(std::size_t done, std::size_t expected);

 private:
  using Clock = std::chrono::steady_clock;

  std::string unit_;
  bool is_terminal_;
  bool drawn_ = false, ended_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_ = start_;
};

}  // namespace cartvo
