// RTP time stamps of one camera, related to the host's clock and to the camera's wall clock.

#include "capture/clock/camera_clock_model.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "common/exact_text.hpp"

namespace cartvo::capture {
namespace {

constexpr double kMaxLatencyStddev_ns = 12e6;
constexpr std::int64_t kMaxEarly_ns = 1'000'000'000;     // against the fastest pictures; a backlog's are near
constexpr std::int64_t kMaxLate_ns = 5'000'000'000;      // a connection without pictures ends sooner
constexpr std::int64_t kMaxStep_ns = 1'000'000'000;      // of a picture that follows the last one
constexpr std::int64_t kMaxReordering_ns = 500'000'000;  // five B-frames at 10 Hz
constexpr int kStraysOfAnEpoch = 3;
constexpr int kUnsteadyStrays = 16;                         // of the latest 32 pictures
constexpr std::int64_t kMaxTicks = std::int64_t{1} << 48;   // 99 years
constexpr std::int64_t kLatest_us = std::int64_t{1} << 52;  // the year 2112; no index has later ones

// Rates of RTP time that a wrong frame rate explains.
constexpr double kMinNominalRate = 0.3;
constexpr double kMaxNominalRate = 3.0;

constexpr double kJumpReported = 10.0;  // s after a jump of RTP time

/// One tick is 100000/9 ns.
std::int64_t ticksToNanoseconds(std::int64_t ticks) {
  return ticks / 9 * 100'000 + ticks % 9 * 100'000 / 9;
}

/// Why a stream's RTP time is not that of the exposures: it runs at another pace than time.
std::string paceProblem(double deviation) {
  const double rate = 1.0 + deviation;
  const bool is_nominal = rate > kMinNominalRate && rate < kMaxNominalRate;
  const std::string problem = "runs " + fixedText(100.0 * std::abs(deviation), 1) + " % too " +
                              (deviation > 0.0 ? "fast" : "slow") + ", so that no motion can be measured: ";
  if (is_nominal)
    return problem + "its frame rate is set to one that it does not reach; set a lower one in the camera";
  return problem + "it counts " + fixedText(90000.0 * rate, 0) +
         " a second, not 90000 (90 kHz); update its firmware";
}

}  // namespace

void CameraClockModel::connect() {
  begin();
  latest_strays_ = 0;
}

void CameraClockModel::begin() {
  const std::uint64_t epoch = epoch_ + 1;
  const std::uint32_t strays = latest_strays_;
  *this = CameraClockModel(default_scatter_ns_);
  epoch_ = epoch;
  latest_strays_ = strays;
}

/// The value nearest to the last time stamp whose lower 32 bits equal those of `pts`. The first one has these
/// 32 bits only. Clamped to 99 years, so that no sum of it overflows.
std::int64_t CameraClockModel::unwrapped(std::int64_t pts) const {
  const std::int64_t last = last_pts_.value_or(static_cast<std::uint32_t>(pts));
  const auto step =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(pts) - static_cast<std::uint32_t>(last));
  return std::clamp(last + step, -kMaxTicks, kMaxTicks);
}

/// Whether a picture may arrive then: not much earlier than the fastest ones, nor later than any network
/// delays it, and not farther behind the last one than B-frames are. One that follows the last one may be
/// later: this process stood still, or RTP time is slow (ArrivalPace).
bool CameraClockModel::isPlausible(std::int64_t rtp_ns, std::int64_t arrival_ns) const {
  const std::int64_t delay_ns = arrival_ns - arrivals_.at(rtp_ns);
  const bool follows = rtp_ns >= rtp_ns_ && rtp_ns - rtp_ns_ <= kMaxStep_ns;
  return delay_ns >= -kMaxEarly_ns && (delay_ns <= kMaxLate_ns || follows) &&
         rtp_ns >= rtp_ns_ - kMaxReordering_ns;
}

/// Whether pictures in a row agree on another RTP time.
bool CameraClockModel::beginsEpoch(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  const std::int64_t step_ns = rtp_ns - strays_.rtp_ns - (arrival_ns - strays_.arrival_ns);
  const bool continues = strays_.count > 0 && std::abs(step_ns) < kMaxEarly_ns;
  strays_ = {rtp_ns, arrival_ns, continues ? strays_.count + 1 : 1};
  return strays_.count >= kStraysOfAnEpoch;
}

bool CameraClockModel::add(const RtpTimestamps& timestamps) {
  std::int64_t pts = unwrapped(timestamps.pts);
  std::int64_t rtp_ns = ticksToNanoseconds(pts);
  const bool is_stray = arrivals_.hasData() && !isPlausible(rtp_ns, timestamps.arrival_ns);
  latest_strays_ = latest_strays_ << 1 | (is_stray ? 1U : 0U);
  if (is_stray) {
    if (!beginsEpoch(rtp_ns, timestamps.arrival_ns)) return false;
    const double jump = static_cast<double>(arrivals_.at(rtp_ns) - timestamps.arrival_ns) * 1e-9;
    begin();
    jump_ = jump;
    pts = unwrapped(timestamps.pts);
    rtp_ns = ticksToNanoseconds(pts);
  }
  strays_ = {};
  last_pts_ = pts;
  rtp_ns_ = rtp_ns;
  if (!first_rtp_ns_) first_rtp_ns_ = rtp_ns_;
  arrivals_.add(rtp_ns_, timestamps.arrival_ns);
  const bool was_settled = pace_.isSettled();
  pace_.add(rtp_ns_, timestamps.arrival_ns);
  if (pace_.isSettled() && !was_settled) arrivals_.forgetEarlierBlocks();  // their pictures were late
  addReport(timestamps);
  return true;
}

void CameraClockModel::addReport(const RtpTimestamps& timestamps) {
  if (!timestamps.reference_us || *timestamps.reference_us < 0 || *timestamps.reference_us > kLatest_us)
    return;
  const std::int64_t expected_ns = reportedNs().value_or(minDelayArrivalNs());
  const auto instant_us =
      report_extractor_.extract(rtp_ns_ / 1000, *timestamps.reference_us, expected_ns / 1000);
  if (instant_us) reports_.add(rtp_ns_, *instant_us * 1000, arrivals_.skew());
}

std::string CameraClockModel::timeBaseProblem() const {
  if (std::popcount(latest_strays_) >= kUnsteadyStrays)
    return "does not go on from picture to picture, so that no exposure is known: update its firmware";
  if (pace_.deviation()) return paceProblem(*pace_.deviation());
  if (pace_.unevenness())
    return "is uneven by " + fixedText(1e-6 * *pace_.unevenness(), 1) +
           " ms, but its pictures arrive evenly, so that velocities are inexact: update its firmware, or set "
           "another frame rate";
  if (jump_ && seconds() < kJumpReported)
    return "jumped by " + fixedText(*jump_, 3) +
           " s within the connection, and its clock began anew: did its encoder restart?";
  return {};
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
