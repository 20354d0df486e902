#include "capture/sender_reports.hpp"

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

/// Two reports that agree to the microsecond look like one; after so long there was another.
constexpr std::int64_t kLongestInterval_us = 10'000'000;

}  // namespace

std::optional<std::int64_t> SenderReports::next(std::int64_t rtp_us, std::int64_t reference_us,
                                                std::int64_t expected_us) {
  const std::int64_t relation_us = reference_us - rtp_us;
  // FFmpeg rounds to microseconds, so the same report may differ by one.
  const bool same = last_reported_us_ && std::abs(relation_us - *last_reported_us_) <= 1;
  if (same && rtp_us - last_rtp_us_ < kLongestInterval_us) return std::nullopt;
  last_reported_us_ = relation_us;
  last_rtp_us_ = rtp_us;
  return reference_us + wholeWraps(expected_us - reference_us) * kWrap_us;
}

/// By how many wraps the last report is off: one at most, and none once it has been so for too long.
std::int64_t SenderReports::wholeWraps(std::int64_t difference_us) {
  const std::int64_t wraps = difference_us > 0 ? 1 : -1;
  const bool wrapped = std::abs(difference_us - wraps * kWrap_us) <= kWrapTolerance_us;
  corrected_reports_ = wrapped ? corrected_reports_ + 1 : 0;
  return wrapped && corrected_reports_ < kReportsToBelieve ? wraps : 0;
}

}  // namespace cartvo
