// The host's clock: monotonic time that began as wall-clock time.

#include "common/host_clock.hpp"

#include <atomic>
#include <chrono>
#include <cstdlib>

namespace cartvo {
namespace {

constexpr std::int64_t kMinStep_ns = 1'000'000;  // less is the time between two readings
constexpr int kReadings = 3;

template <typename Clock>
std::int64_t now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

/// Wall clock minus monotonic clock, ns. The reading that took the shortest time is the most exact one.
std::int64_t difference() {
  std::int64_t shortest = INT64_MAX;
  std::int64_t result = 0;
  for (int i = 0; i < kReadings; ++i) {
    const std::int64_t before = now<std::chrono::steady_clock>();
    const std::int64_t wall = now<std::chrono::system_clock>();
    const std::int64_t took = now<std::chrono::steady_clock>() - before;
    if (took >= shortest) continue;
    shortest = took;
    result = wall - before - took / 2;
  }
  return result;
}

std::int64_t differenceAtBegin() {
  static const std::int64_t value = difference();
  return value;
}

}  // namespace

std::int64_t hostNow() {
  return hostTimeOfMonotonic(now<std::chrono::steady_clock>());
}

std::int64_t hostTimeOfMonotonic(std::int64_t monotonic_ns) {
  return monotonic_ns + differenceAtBegin();
}

std::int64_t hostClockCorrection() {
  static std::atomic<std::int64_t> correction = 0;
  const std::int64_t current = difference() - differenceAtBegin();
  if (std::llabs(current - correction) >= kMinStep_ns) correction = current;
  return correction;
}

}  // namespace cartvo
