#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

#include "tools/subscribers/latest_odometry.hpp"

namespace cartvo {

inline std::int64_t nowUtime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// A controller's turn, without end: waits for odometry and prints, a line each, what `command` makes of a
/// usable message, or `fallback`, what the controller does without one. `command` is a `std::string(const
/// odometry_t&)`. Returns the program's exit code if LCM cannot be reached.
template <typename Command>
int runController(const std::string& lcm_url, const char* fallback, Command command) {
  constexpr int kSilence_ms = 500;  // nine frames at 18 fps: the daemon is dead
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  lcm::LCM lcm(lcm_url);
  if (!lcm.good()) {
    std::fprintf(stderr, "no LCM at %s: is there a multicast route? See cartvod(8)\n", lcm_url.c_str());
    return 1;
  }
  LatestOdometry odometry(lcm);
  for (;;) {
    if (!odometry.update(kSilence_ms)) {
      std::printf("silence: cartvod is not running; %s\n", fallback);
      continue;
    }
    const odometry_t& message = odometry.message();
    const std::int64_t now = nowUtime();
    const double age_ms = static_cast<double>(now - message.utime) * 1e-3;
    if (odometry.isUsable(now)) {
      std::printf("%s  age %5.1f ms  lost %lld\n", command(message).c_str(), age_ms,
                  static_cast<long long>(odometry.lost()));
    } else {
      std::printf("unusable: status %d, reasons %d, age %.1f ms; %s\n", message.status, message.reasons,
                  age_ms, fallback);
    }
  }
}

}  // namespace cartvo
