#pragma once

#include <sys/resource.h>

namespace cartvo {

/// Gives the calling thread, and threads that it starts, a priority at which threads of the ordinary one take
/// ten times their share of a busy processor. Returns false if the operating system does not permit it.
inline bool lowerThreadPriority() {
  constexpr int kNice = 10, kThisThread = 0;
  return setpriority(PRIO_PROCESS, kThisThread, kNice) == 0;
}

}  // namespace cartvo
