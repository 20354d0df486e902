#pragma once

#include <optional>

#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/work_observer.hpp"

namespace cartvo {

/// Shows on the error output the current step of long work and its progress, as ProgressBar does.
class WorkDisplay {
 public:
  /// For calls in one thread, while this object lives.
  WorkObserver observer();

  /// Ends the current step: on a terminal its line is erased.
  void end() { bar_.reset(); }

 private:
  std::optional<ProgressBar> bar_;
};

}  // namespace cartvo
