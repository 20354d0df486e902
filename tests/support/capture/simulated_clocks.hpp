#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "capture/clock/camera_clock_model.hpp"

namespace cartvo::test {

/// Clock errors and network delays of one camera. Instants are seconds of true time, equal to the host's
/// clock.
struct ClockFaults {
  double frame_rate = 25.0;      ///< by the camera's crystal, Hz
  double first_exposure = 0.0;   ///< s
  double skew = 0.0;             ///< of the crystal
  double skew_drift = 0.5e-6;    ///< change of the skew within an hour
  std::uint32_t first_rtp = 0;   ///< RTP time at 0 s
  double latency = 0.08;         ///< exposure to sending, s
  double jitter = 1e-3;          ///< mean network delay, s
  double burst = 0.05;           ///< maximum extra delay of one packet in a hundred, s
  double report_interval = 5.0;  ///< s; 0: no sender reports
  double report_noise = 0.02;    ///< standard deviation, s
  std::function<double(double)> clock_error = [](double) { return 0.0; };  ///< of the camera's wall clock, s
};

/// Simulates the time stamps received from such a camera, as FFmpeg 5.1 reports them, including FFmpeg's
/// error after a wrap of RTP time.
class ClockSimulation {
 public:
  static constexpr std::int64_t kEpoch_ns = 1'700'000'000'000'000'000;

  ClockSimulation(const ClockFaults& faults, unsigned seed) : faults_(faults), random_(seed) {}

  /// True exposure of the next picture, s.
  double nextExposure() const { return exposureOf(count_); }

  capture::RtpTimestamps next() {
    const double exposure = nextExposure();
    ++count_;
    capture::RtpTimestamps packet;
    const std::int64_t rtp = rtpAt(exposure);
    packet.pts = static_cast<std::uint32_t>(rtp);
    packet.arrival_ns = atHost(exposure + faults_.latency + delay());
    report(exposure);
    if (reported_) {
      const std::int64_t ticks = static_cast<std::int64_t>(static_cast<std::uint32_t>(rtp)) -
                                 static_cast<std::int64_t>(static_cast<std::uint32_t>(reported_rtp_));
      packet.reference_us = reported_ns_ / 1000 + std::llround(static_cast<double>(ticks) * 1e6 / 90000.0);
    }
    return packet;
  }

  static std::int64_t atHost(double seconds) { return kEpoch_ns + std::llround(seconds * 1e9); }

 private:
  double exposureOf(std::int64_t count) const {
    const double own = faults_.first_exposure + static_cast<double>(count) / faults_.frame_rate;
    return own / (1.0 + faults_.skew);
  }

  std::int64_t rtpAt(double time) const {
    constexpr double kHour = 3600.0 / (2.0 * M_PI);
    const double drifted = faults_.skew_drift * kHour * std::sin(time / kHour);
    return faults_.first_rtp + std::llround(90000.0 * (time * (1.0 + faults_.skew) + drifted));
  }

  double delay() {
    const double usual = -faults_.jitter * std::log(1.0 - uniform());
    return uniform() < 0.01 ? usual + faults_.burst * uniform() : usual;
  }

  void report(double now) {
    if (faults_.report_interval <= 0.0 || now < next_report_) return;
    next_report_ = now + faults_.report_interval;
    reported_ = true;
    reported_rtp_ = rtpAt(now);
    reported_ns_ = atHost(now + faults_.clock_error(now) + faults_.report_noise * normal());
  }

  double uniform() { return static_cast<double>(random_()) / 4294967296.0; }
  double normal() { return std::sqrt(-2.0 * std::log(1.0 - uniform())) * std::cos(2.0 * M_PI * uniform()); }

  ClockFaults faults_;
  std::mt19937 random_;
  std::int64_t count_ = 0;
  double next_report_ = 1.0;
  bool reported_ = false;
  std::int64_t reported_rtp_ = 0;
  std::int64_t reported_ns_ = 0;
};

}  // namespace cartvo::test
