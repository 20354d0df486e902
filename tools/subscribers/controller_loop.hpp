#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

#include "tools/subscribers/latest_odometry.hpp"

namespace cartvo {

/// Current system time, us since the Unix epoch.
inline std::int64_t nowUtime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// Why no usable odometry came within the time of silence.
inline std::string silenceText(const LatestOdometry& odometry, std::uint64_t undecodable_before) {
  if (odometry.undecodable() > undecodable_before)
    return "messages come, but cannot be decoded: cartvod is of another release";
  return "no message, cartvod is not running";
}

/// Endless control loop: waits for odometry and prints one line per message: `command(message)` if the
/// message is usable, else `fallback`, the action without odometry. `command` has type `std::string(const
/// odometry_t&)`. Returns, with the program's exit code, only if LCM cannot be reached.
template <typename Command>
int runController(const std::string& lcm_url, const char* fallback, Command command) {
  constexpr int kSilenceTimeout_ms = 500;  // nine frames at 18 fps
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  lcm::LCM lcm(lcm_url);
  if (!lcm.good()) {
    std::fprintf(stderr, "cannot open LCM at %s: check that a multicast route exists, see cartvod(8)\n",
                 lcm_url.c_str());
    return 1;
  }
  LatestOdometry odometry(lcm);
  for (;;) {
    const std::uint64_t undecodable = odometry.undecodable();
    if (!odometry.update(kSilenceTimeout_ms)) {
      std::printf("%s (%d ms); %s\n", silenceText(odometry, undecodable).c_str(), kSilenceTimeout_ms,
                  fallback);
      continue;
    }
    const odometry_t& message = odometry.message();
    const std::int64_t now = nowUtime();
    const double age_ms = static_cast<double>(ageUs(message, now)) * 1e-3;
    const OdometryVerdict verdict = odometry.verdict(now);
    if (verdict == OdometryVerdict::usable) {
      std::printf("%s  age %5.1f ms  lost %lld\n", command(message).c_str(), age_ms,
                  static_cast<long long>(odometry.lost()));
    } else {
      std::printf("unusable: %s%s; status %d, reasons %d, age %.1f ms; %s\n", verdictText(verdict),
                  odometry.hasTwoPublishers() ? " (two daemons publish)" : "", message.status,
                  message.reasons, age_ms, fallback);
    }
  }
}

}  // namespace cartvo
