#pragma once

#include <chrono>
#include <cstdint>

namespace cartvo {

/// Reads the host's clock, ns since the Unix epoch; arrival and publication times are in this clock.
inline std::int64_t hostNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace cartvo
