#pragma once

#include <functional>
#include <string>

namespace cartvo {

/// A step of long work.
struct WorkStep {
  std::string name;            ///< for the user, such as "encoding"
  std::string unit = "pairs";  ///< name of the counted things, plural; "s": its time is counted
};

/// Receives each step of long work when it begins, then its progress.
struct WorkObserver {
  using Progress = std::function<void(int done, int total)>;

  std::function<void(const WorkStep&)> begin;
  Progress progress;
};

}  // namespace cartvo
