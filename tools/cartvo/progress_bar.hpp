#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace cartvo {

/// A line on the error output that shows how far a long work is; silent where that is no terminal. Erased at
/// the end.
class ProgressBar {
 public:
  /// `unit`: what is counted, in the plural.
  explicit ProgressBar(std::string unit);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `expected`: how many there will be; 0 if that is not known. Draws at most ten times a second.
  void show(std::size_t done, std::size_t expected);

 private:
  using Clock = std::chrono::steady_clock;

  std::string unit_;
  bool is_terminal_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_;
};

}  // namespace cartvo
