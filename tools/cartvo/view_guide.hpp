#pragma once

#include <chrono>

#include "tools/calibrate/stream_views.hpp"

namespace cartvo {

/// Tells a person before the cameras, on the error output, what to do: a line for each view taken or
/// rejected, and what is seen now. On a terminal that is a line that renews itself; elsewhere one comes each
/// ten seconds.
class ViewGuide {
 public:
  ViewGuide();

  void show(const StreamProgress& progress);

  /// Leaves the terminal clean for what follows.
  void end();

 private:
  using Clock = std::chrono::steady_clock;

  void sayView(const StreamProgress& progress);

  bool is_terminal_;
  bool drawn_ = false;
  Clock::time_point last_drawn_;
};

}  // namespace cartvo
