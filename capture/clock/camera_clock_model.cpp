// RTP time stamps of one camera, related to the host's clock and to the camera's wall clock.

#include "capture/clock/camera_clock_model.hpp"

#include <algorithm>

namespace cartvo::capture {
namespace {

constexpr double kMaxLatencyStddev_ns = 12e6;
constexpr std::int64_t kMaxTicks = std::int64_t{1} << 48;   // 99 years
constexpr std::int64_t kLatest_us = std::int64_t{1} << 52;  // the year 2112; later reports are invalid

/// One tick is 100000/9 ns.
std::int64_t ticksToNanoseconds(std::int64_t ticks) {
  return ticks / 9 * 100'000 + ticks % 9 * 100'000 / 9;
}

}  // namespace

void CameraClockModel::connect() {
  *this = CameraClockModel(default_scatter_ns_);
}

/// The value nearest to the last time stamp whose lower 32 bits equal those of `pts`. The first one has these
/// 32 bits only. Clamped to 99 years, so that no sum of it overflows.
std::int64_t CameraClockModel::unwrapped(std::int64_t pts) {
  const std::int64_t last = last_pts_.value_or(static_cast<std::uint32_t>(pts));
  const auto step =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(pts) - static_cast<std::uint32_t>(last));
  last_pts_ = std::clamp(last + step, -kMaxTicks, kMaxTicks);
  return *last_pts_;
}

void CameraClockModel::add(const RtpTimestamps& timestamps) {
  rtp_ns_ = ticksToNanoseconds(unwrapped(timestamps.pts));
  if (!first_rtp_ns_) first_rtp_ns_ = rtp_ns_;
  arrivals_.add(rtp_ns_, timestamps.arrival_ns);
  if (!timestamps.reference_us || *timestamps.reference_us < 0 || *timestamps.reference_us > kLatest_us)
    return;
  const std::int64_t expected_ns = reportedNs().value_or(minDelayArrivalNs());
  const auto instant_us =
      report_extractor_.extract(rtp_ns_ / 1000, *timestamps.reference_us, expected_ns / 1000);
  if (instant_us) reports_.add(rtp_ns_, *instant_us * 1000, arrivals_.skew());
}

std::optional<std::int64_t> CameraClockModel::reportedNs() const {
  if (!reports_.hasData()) return std::nullopt;
  return reports_.at(rtp_ns_);
}

std::optional<std::int64_t> CameraClockModel::latencyNs() const {
  if (!reports_.hasData() || reportedStddevNs() > kMaxLatencyStddev_ns) return std::nullopt;
  return minDelayArrivalNs() - reports_.at(rtp_ns_);
}

}  // namespace cartvo::capture
