#pragma once

#include <cstdint>

namespace cartvo {

/// Reads the host's clock, ns since the Unix epoch as the wall clock told it when the process began, plus the
/// monotonic time since then. All instants within the process are in this clock, so that setting the wall
/// clock (by NTP after a start without a network, or by hand) changes no duration and no order.
std::int64_t hostNow();

/// The instant of hostNow() at which CLOCK_MONOTONIC shows `monotonic_ns`.
std::int64_t hostTimeOfMonotonic(std::int64_t monotonic_ns);

/// Wall clock minus hostNow(), ns: 0 until the wall clock is set by a millisecond or more. What leaves the
/// process as a time stamp is hostNow() plus this.
std::int64_t hostClockCorrection();

/// Reads the wall clock, ns since the Unix epoch.
inline std::int64_t wallClockNow() {
  return hostNow() + hostClockCorrection();
}

}  // namespace cartvo
