// Keeps secrets in memory out of core dumps.

#include "common/core_dump.hpp"

#include <sys/prctl.h>
#include <sys/resource.h>

namespace cartvo {

void disableCoreDumps() {
  // The resource limit alone does not stop dumps into a pipe (core(5)). Neither call fails for these values.
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  prctl(PR_SET_DUMPABLE, 0L, 0L, 0L, 0L);
}

}  // namespace cartvo
