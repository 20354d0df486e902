#include "capture/exposure_clock.hpp"

#include <cmath>
#include <cstdlib>

namespace cartvo {
namespace {

constexpr std::int64_t kTicksPerSecond = 90000;
constexpr std::int64_t kWrap_us = (std::int64_t{1} << 32) * 1000000 / kTicksPerSecond;

/// How far a relation may lie from a whole number of wraps and still be taken for one: reports are up to
/// hundreds of milliseconds off, and clocks are set between two.
constexpr std::int64_t kWrapTolerance_us = 2000000;

/// The fault lasts until the report after the wrap. What holds for longer is the camera's clock.
constexpr int kReportsToBelieve = 3;

std::int64_t ticksToMicroseconds(std::int64_t ticks) {
  return ticks / kTicksPerSecond * 1000000 + ticks % kTicksPerSecond * 1000000 / kTicksPerSecond;
}

/// The whole number of wraps that `difference` is, or 0 if it is none.
std::int64_t wraps(std::int64_t difference_us) {
  const auto nearest = static_cast<std::int64_t>(
      std::llround(static_cast<double>(difference_us) / static_cast<double>(kWrap_us)));
  return std::abs(difference_us - nearest * kWrap_us) <= kWrapTolerance_us ? nearest : 0;
}

}  // namespace

ExposureClock::Instant ExposureClock::stamp(std::int64_t pts, std::optional<std::int64_t> reference_us,
                                            std::int64_t arrival_ns) {
  const std::int64_t rtp_us = ticksToMicroseconds(pts);
  if (reference_us) update(*reference_us - rtp_us, arrival_ns / 1000 - rtp_us);
  if (!relation_us_) return {arrival_ns, InstantSource::arrival, usualDeviationNs(InstantSource::arrival)};
  const std::int64_t exposure_us = reference_us ? *reference_us + correction_us_ : rtp_us + *relation_us_;
  return {exposure_us * 1000, InstantSource::sender_report, usualDeviationNs(InstantSource::sender_report)};
}

/// `relation_us` and `arrival_relation_us`: instant minus RTP time by the report and by arrival.
void ExposureClock::update(std::int64_t relation_us, std::int64_t arrival_relation_us) {
  // FFmpeg rounds to microseconds, so the same report may differ by one.
  const bool new_report = !last_reported_us_ || std::abs(relation_us - *last_reported_us_) > 1;
  if (!new_report) return;
  last_reported_us_ = relation_us;
  // Without an earlier report the host's clock tells whether the connection began on a wrap.
  const std::int64_t expected_us = relation_us_.value_or(arrival_relation_us);
  std::int64_t count = wraps(expected_us - relation_us);
  corrected_reports_ = count == 0 ? 0 : corrected_reports_ + 1;
  if (corrected_reports_ >= kReportsToBelieve) {
    corrected_reports_ = 0;
    count = 0;
  }
  correction_us_ = count * kWrap_us;
  relation_us_ = relation_us + correction_us_;
}

}  // namespace cartvo
