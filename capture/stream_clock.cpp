#include "capture/stream_clock.hpp"

#include <algorithm>

namespace cartvo {
namespace {

constexpr double kKnown_ns = 12e6;
constexpr std::int64_t kMostTicks = std::int64_t{1} << 48;
constexpr std::int64_t kLatest_us = std::int64_t{1} << 52;  // the year 2112; beyond it a report is garbage

/// A tick is 100000/9 ns.
std::int64_t ticksToNanoseconds(std::int64_t ticks) {
  return ticks / 9 * 100'000 + ticks % 9 * 100'000 / 9;
}

}  // namespace

void StreamClock::connect() {
  *this = StreamClock(usual_scatter_ns_);
}

/// The continuation of the last time stamp that agrees with this one in 32 bits and is nearest to it. It
/// begins with these 32 bits, and what has run 99 years from there is followed no further: no sum of it
/// overflows.
std::int64_t StreamClock::unwrapped(std::int64_t pts) {
  const std::int64_t last = last_pts_.value_or(static_cast<std::uint32_t>(pts));
  const auto step =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(pts) - static_cast<std::uint32_t>(last));
  last_pts_ = std::clamp(last + step, -kMostTicks, kMostTicks);
  return *last_pts_;
}

void StreamClock::add(const StampedPacket& packet) {
  rtp_ns_ = ticksToNanoseconds(unwrapped(packet.pts));
  if (!first_rtp_ns_) first_rtp_ns_ = rtp_ns_;
  arrivals_.add(rtp_ns_, packet.arrival_ns);
  if (!packet.reference_us || *packet.reference_us < 0 || *packet.reference_us > kLatest_us) return;
  const std::int64_t expected_ns = reportedNs().value_or(undelayedArrivalNs());
  const auto instant_us = sender_reports_.next(rtp_ns_ / 1000, *packet.reference_us, expected_ns / 1000);
  if (instant_us) reports_.add(rtp_ns_, *instant_us * 1000, arrivals_.skew());
}

std::optional<std::int64_t> StreamClock::reportedNs() const {
  if (!reports_.known()) return std::nullopt;
  return reports_.at(rtp_ns_);
}

std::optional<std::int64_t> StreamClock::latencyNs() const {
  if (!reports_.known() || reportedDeviationNs() > kKnown_ns) return std::nullopt;
  return undelayedArrivalNs() - reports_.at(rtp_ns_);
}

}  // namespace cartvo
