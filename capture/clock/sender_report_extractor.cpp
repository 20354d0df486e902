// Detection of new RTCP sender reports, and correction of wraps of RTP time in older recordings.

#include "capture/clock/sender_report_extractor.hpp"

#include <cstdlib>

namespace cartvo::capture {
namespace {

constexpr std::int64_t kTicksPerSecond = 90000;
constexpr std::int64_t kWrap_us = (std::int64_t{1} << 32) * 1000000 / kTicksPerSecond;

/// Tolerance for a difference of one wrap: reports are off by up to hundreds of milliseconds, and clocks are
/// set between two reports.
constexpr std::int64_t kWrapTolerance_us = 2000000;

/// FFmpeg's error lasts until the report after the wrap. From this many reports in a row on, the difference
/// is the camera's clock and is not corrected.
constexpr int kClockErrorReports = 3;

/// Two reports that agree to the microsecond are indistinguishable; after this time there was another one.
constexpr std::int64_t kMaxReportInterval_us = 10'000'000;

}  // namespace

std::optional<std::int64_t> SenderReportExtractor::extract(std::int64_t rtp_us, std::int64_t reference_us,
                                                           std::int64_t expected_us) {
  const std::int64_t offset_us = reference_us - rtp_us;
  // Instants are whole microseconds, so the same report may differ by one.
  const bool same = last_offset_us_ && std::abs(offset_us - *last_offset_us_) <= 1;
  if (same && rtp_us - last_rtp_us_ < kMaxReportInterval_us) return std::nullopt;
  last_offset_us_ = offset_us;
  last_rtp_us_ = rtp_us;
  return reference_us + missingWraps(expected_us - reference_us) * kWrap_us;
}

/// Number of wraps by which the report is off: -1, 0 or 1; 0 from kClockErrorReports reports on.
std::int64_t SenderReportExtractor::missingWraps(std::int64_t difference_us) {
  const std::int64_t wraps = difference_us > 0 ? 1 : -1;
  const bool wrapped = std::abs(difference_us - wraps * kWrap_us) <= kWrapTolerance_us;
  corrected_reports_ = wrapped ? corrected_reports_ + 1 : 0;
  return wrapped && corrected_reports_ < kClockErrorReports ? wraps : 0;
}

}  // namespace cartvo::capture
