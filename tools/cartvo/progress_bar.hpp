#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace cartvo {

/// A line on the error output that shows how far a long work is, its rate and the time left. On a terminal it
/// renews itself and is erased at the end; elsewhere a line comes each ten seconds.
class ProgressBar {
 public:
  /// `unit`: what is counted, in the plural.
  explicit ProgressBar(std::string unit);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `expected`: how many there will be; 0 if that is not known. Call it as often as you like.
  void show(std::size_t done, std::size_t expected);

 private:
  using Clock = std::chrono::steady_clock;

  std::string unit_;
  bool is_terminal_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_ = start_;
};

}  // namespace cartvo
