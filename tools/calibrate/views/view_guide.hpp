#pragma once

#include <chrono>

#include "tools/calibrate/views/stream_views.hpp"

namespace cartvo {

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
