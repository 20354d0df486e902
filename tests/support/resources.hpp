#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <unistd.h>

namespace cartvo::test {

/// The resources of this process that a leak increases.
struct Resources {
  std::ptrdiff_t descriptors = 0;
  std::ptrdiff_t threads = 0;
  double megabytes = 0.0;  ///< resident memory
};

/// Reads the current resources from /proc.
inline Resources resourcesInUse() {
  using std::filesystem::directory_iterator;
  Resources now;
  now.descriptors = std::distance(directory_iterator("/proc/self/fd"), directory_iterator());
  now.threads = std::distance(directory_iterator("/proc/self/task"), directory_iterator());
  std::ifstream statm("/proc/self/statm");
  double total = 0.0;
  double resident = 0.0;
  statm >> total >> resident;
  now.megabytes = resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
  return now;
}

}  // namespace cartvo::test
