#pragma once

#include <chrono>
#include <cstdint>

namespace cartvo {

/// The host's clock, ns since the Unix epoch: what arrival and publication instants are taken from.
inline std::int64_t hostNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace cartvo
