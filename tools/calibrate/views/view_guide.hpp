#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "tools/calibrate/views/stream_views.hpp"

namespace cartvo {

/// The line of the guide in at most `columns`: time, number of views, detected corners and what to do. The
/// corners are left out first.
std::string guideLine(const StreamProgress& progress, std::size_t columns);

/// Guides the person who holds the board, on standard error: a line for each view accepted or rejected, and a
/// line with the detected corners and what to do. The latter is redrawn in place on a terminal and printed
/// every ten seconds otherwise.
class ViewGuide {
 public:
  ViewGuide();

  void show(const StreamProgress& progress);

  /// Erases the status line from the terminal.
  void end();

 private:
  using Clock = std::chrono::steady_clock;

  void printView(const StreamProgress& progress);

  bool is_terminal_;
  bool drawn_ = false;
  Clock::time_point last_drawn_;
};

}  // namespace cartvo
