// Combination of the offset estimates between two cameras, and slewing of their exposures.

#include "capture/clock/stereo_timestamper.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/exact_text.hpp"

namespace cartvo::capture {
namespace {

// Standard deviations of each estimate's assumption.
constexpr double kLatencyDifferenceStddev_ns = 1e6;  // two cameras of one model and settings
constexpr double kNtpDifferenceStddev_ns = 1e6;  // two clocks that follow one NTP server in the same network

constexpr double kGate = 3.0;                      // standard deviations
constexpr double kReportedDisagreement_ns = 5e6;   // smaller ones are no problem to report
constexpr double kMaxLatencyDifference_ns = 20e6;  // plausible between two cameras
constexpr double kMinLateness_ns = 100e6;          // of one camera whose pictures are held back

constexpr double kSlewRate = 0.005;        // of the elapsed time
constexpr double kInitialSlewRate = 0.25;  // in the first seconds of a connection
constexpr std::int64_t kMaxSlewStep_ns = 1'000'000'000;
constexpr double kMaxReportOffset_ns = 500e6;  // larger ones are two clocks that do not agree
constexpr std::int64_t kMinExposureStep_ns = 1'000'000;

constexpr double kUnsettledStddev_ns = 1e9;  // more than any limit of the offset's uncertainty

// Uncertainty that is reported: the default limit of the odometry, for most of some seconds.
constexpr double kReportedStddev_ns = 10e6;
constexpr double kReportedShare = 0.5;
constexpr double kShareGain = 1.0 / 200.0;  // of one picture

// Sender reports of which is said that they are not used.
constexpr double kFirstReportTimeout = 15.0;     // s; cameras send reports every few seconds
constexpr std::uint64_t kReportsForScatter = 8;  // the mean of fewer is often uncertain
constexpr std::uint64_t kMinLeftOut = 4;
constexpr double kMaxShareLeftOut = 0.1;

constexpr double kMinLatency_ns = -50e6;  // negative by the difference of the two clocks
constexpr double kMaxLatency_ns = 3e9;

bool isPlausible(double latency_ns) {
  return latency_ns >= kMinLatency_ns && latency_ns <= kMaxLatency_ns;
}

double square(double value) {
  return value * value;
}

bool agree(const OffsetEstimate& a, const OffsetEstimate& b) {
  return std::abs(a.value_ns - b.value_ns) <= kGate * std::hypot(a.stddev_ns, b.stddev_ns);
}

/// Mean weighted by the inverse variances. Its variance is inflated by the reduced chi-square where that
/// exceeds 1.
OffsetEstimate weightedMean(const std::vector<OffsetEstimate>& estimates) {
  double weight = 0.0;
  double sum = 0.0;
  for (const OffsetEstimate& e : estimates) {
    weight += 1.0 / square(e.stddev_ns);
    sum += e.value_ns / square(e.stddev_ns);
  }
  const double value = sum / weight;
  double chi_square = 0.0;
  for (const OffsetEstimate& e : estimates)
    chi_square += square((e.value_ns - value) / e.stddev_ns);
  const double inflation = chi_square / std::max(static_cast<double>(estimates.size()) - 1.0, 1.0);
  return {value, std::sqrt(std::max(inflation, 1.0) / weight)};
}

/// Standard deviation of one report while there are too few to estimate it, ns. With `ntp` the user asserts
/// that the reports are exact; otherwise cameras may stamp them on sending.
double defaultScatterNs(ClockChoice choice) {
  return choice == ClockChoice::ntp ? 1e6 : 20e6;
}

std::string nameOf(std::size_t side) {
  return std::string("the ") + sideName(static_cast<CameraSide>(side)) + " camera";
}

std::string inSeconds(double nanoseconds) {
  return fixedText(std::abs(nanoseconds) * 1e-9, 3) + " s";
}

}  // namespace

void setTimestamp(EncodedUnit& unit, const ExposureTimestamp& timestamp) {
  static_cast<ExposureInstant&>(unit) = timestamp;
  if (!timestamp.is_usable) unit.status = FrameStatus::damaged;
}

StereoTimestamper::StereoTimestamper(ClockChoice choice)
    : choice_(choice), sides_{Side(defaultScatterNs(choice)), Side(defaultScatterNs(choice))} {}

void StereoTimestamper::connect(CameraSide which) {
  const std::lock_guard lock(mutex_);
  Side& side = sides_[static_cast<std::size_t>(which)];
  side.clock.connect();
  side.connected = false;
}

ExposureTimestamp StereoTimestamper::stamp(CameraSide which, const RtpTimestamps& timestamps) {
  const std::lock_guard lock(mutex_);
  Side& side = sides_[static_cast<std::size_t>(which)];
  ExposureTimestamp timestamp;
  timestamp.is_usable = side.clock.add(timestamps);
  if (timestamp.is_usable) {
    updateTargets(timestamps.arrival_ns);
    advance(side, timestamps.arrival_ns);
  } else if (side.last_exposure_ns) {
    *side.last_exposure_ns += kMinExposureStep_ns;
    side.slew_ns += kMinExposureStep_ns;
  }
  const double stddev = uncertainty();
  uncertain_share_ += kShareGain * ((stddev > kReportedStddev_ns ? 1.0 : 0.0) - uncertain_share_);
  timestamp.exposure_ns = side.last_exposure_ns.value_or(timestamps.arrival_ns);
  timestamp.exposure_stddev_ns = std::llround(stddev / std::sqrt(2.0));
  timestamp.min_delay_arrival_ns = side.clock.minDelayArrivalNs();
  timestamp.slew_ns = side.slew_ns;
  timestamp.instant_source = source_;
  return timestamp;
}

/// Standard deviation of the two cameras' offset as stamped, ns.
double StereoTimestamper::uncertainty() const {
  double stddev = std::hypot(offset_.stddev_ns, sides_[1].lag_ns - sides_[0].lag_ns);
  for (const Side& side : sides_)
    if (side.connected && !side.clock.pace().isSettled()) stddev = std::max(stddev, kUnsettledStddev_ns);
  return stddev;
}

void StereoTimestamper::setHostClockCorrection(std::int64_t correction_ns) {
  const std::lock_guard lock(mutex_);
  host_clock_correction_ns_ = static_cast<double>(correction_ns);
}

void StereoTimestamper::setVisual(const std::optional<OffsetEstimate>& offset) {
  const std::lock_guard lock(mutex_);
  visual_ = offset;
}

void StereoTimestamper::setReportNote(CameraSide which, const std::string& note) {
  const std::lock_guard lock(mutex_);
  report_notes_[static_cast<std::size_t>(which)] = note;
}

/// Updates the desired exposures of both cameras relative to their minimum-delay arrivals.
void StereoTimestamper::updateTargets(std::int64_t arrival_ns) {
  const OffsetEstimate arrival = offsetByArrival();
  reports_ = offsetByReports();
  selectOffset(arrival);
  slewLatency(arrival_ns);
  sides_[0].target_ns = -latency_ns_ - 0.5 * offset_.value_ns;
  sides_[1].target_ns = -latency_ns_ + 0.5 * offset_.value_ns;
}

/// Slews the latency that both cameras have in common by the host's time, so that both pictures of a pair are
/// corrected alike, whichever comes first.
void StereoTimestamper::slewLatency(std::int64_t arrival_ns) {
  const double latency_ns = choice_ == ClockChoice::arrival ? 0.0 : commonLatencyNs();
  const bool is_initial = std::none_of(sides_.begin(), sides_.end(), [](const Side& side) {
    return side.connected && side.clock.arrivals().isMature();
  });
  const std::int64_t elapsed_ns = arrival_ns - latency_at_ns_.value_or(arrival_ns);
  const double limit_ns = (is_initial ? kInitialSlewRate : kSlewRate) *
                          static_cast<double>(std::clamp(elapsed_ns, std::int64_t{0}, kMaxSlewStep_ns));
  latency_ns_ += std::clamp(latency_ns - latency_ns_, -limit_ns, limit_ns);
  latency_at_ns_ =
      elapsed_ns > 0 || elapsed_ns < -kMaxSlewStep_ns ? arrival_ns : latency_at_ns_.value_or(arrival_ns);
}

OffsetEstimate StereoTimestamper::offsetByArrival() const {
  double variance = square(kLatencyDifferenceStddev_ns);
  for (const Side& side : sides_)
    variance += square(side.clock.arrivals().stddevNs());
  return {0.0, std::sqrt(variance)};
}

/// Nothing unless each connected camera has sent reports. With one connected camera the value is 0.
std::optional<OffsetEstimate> StereoTimestamper::offsetByReports() const {
  std::array<double, 2> latencies{};
  double variance = square(kNtpDifferenceStddev_ns);
  bool both = true;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const CameraClockModel& clock = sides_[i].clock;
    const std::optional<std::int64_t> latency_ns = clock.latencyNs();
    if (!latency_ns && sides_[i].connected) return std::nullopt;
    if (latency_ns) variance += square(clock.reportedStddevNs());
    latencies[i] = static_cast<double>(latency_ns.value_or(0));
    both = both && latency_ns;
  }
  if (!both && !sides_[0].connected && !sides_[1].connected) return std::nullopt;
  return OffsetEstimate{both ? latencies[0] - latencies[1] : 0.0, std::sqrt(variance)};
}

void StereoTimestamper::selectOffset(const OffsetEstimate& arrival) {
  const std::optional<OffsetEstimate>& better =
      choice_ == ClockChoice::automatic || choice_ == ClockChoice::visual ? visual_ : std::nullopt;
  reports_agree_ = reports_ && agree(*reports_, better.value_or(arrival));
  offset_ = arrival;
  source_ = InstantSource::arrival;
  switch (choice_) {
    case ClockChoice::automatic:
      return combineOffsets(arrival);
    case ClockChoice::ntp:
      if (!reports_ || std::abs(reports_->value_ns) > kMaxReportOffset_ns) return;
      reports_agree_ = true;
      offset_ = *reports_;
      source_ = InstantSource::sender_report;
      return;
    case ClockChoice::arrival:
      return;
    case ClockChoice::visual:
      if (!visual_) return;
      offset_ = *visual_;
      source_ = InstantSource::pictures;
      return;
  }
}

void StereoTimestamper::combineOffsets(const OffsetEstimate& arrival) {
  std::vector<OffsetEstimate> estimates;
  if (!visual_ || agree(arrival, *visual_)) estimates.push_back(arrival);
  if (reports_agree_) estimates.push_back(*reports_);
  if (visual_) estimates.push_back(*visual_);
  offset_ = weightedMean(estimates);
  if (visual_) {
    source_ = InstantSource::pictures;
  } else if (reports_agree_) {
    source_ = InstantSource::sender_report;
  } else if (reports_ && std::abs(reports_->value_ns) < kMaxLatencyDifference_ns) {
    // Either the clocks disagree or the latencies do: ambiguous.
    offset_.stddev_ns = std::max(offset_.stddev_ns, 0.5 * std::abs(reports_->value_ns));
  }
}

std::string StereoTimestamper::problem() const {
  for (std::size_t i = 0; i < sides_.size(); ++i)
    if (const std::string fault = sides_[i].clock.timeBaseProblem(); !fault.empty())
      return nameOf(i) + "'s RTP time " + fault;
  for (std::size_t i = 0; choice_ == ClockChoice::ntp && i < sides_.size(); ++i)
    if (std::string missing = missingReports(i); !missing.empty()) return missing;
  const bool reports_matter = choice_ == ClockChoice::automatic || choice_ == ClockChoice::ntp;
  const double difference = reports_ ? reports_->value_ns - offset_.value_ns : 0.0;
  if (!reports_matter || !reports_ || reports_agree_ || std::abs(difference) < kReportedDisagreement_ns)
    return uncertaintyProblem();
  const std::string text = "the cameras' clocks disagree by " + inSeconds(difference);
  const double size_ns = std::abs(difference);
  if (size_ns > kMinLateness_ns && size_ns < kMaxLatency_ns)
    return text + ", or " + nameOf(difference > 0.0 ? 0 : 1) +
           "'s pictures come late; synchronise both by NTP; if they are, connect without a re-streamer";
  return text + ": synchronise both to one NTP server near them; until then exposures are computed from " +
         (source_ == InstantSource::pictures ? "the image content" : "arrival times");
}

/// Why a camera's sender reports do not tell its exposures; empty if they do, or may yet.
std::string StereoTimestamper::missingReports(std::size_t side) const {
  const CameraClockModel& clock = sides_[side].clock;
  const std::string& note = report_notes_[side];
  std::string found;
  if (clock.latencyNs()) return {};
  if (clock.reports().reports() >= kReportsForScatter) {
    found = " sends RTCP sender reports that scatter by " + inSeconds(clock.reports().scatterNs());
  } else if (clock.seconds() > kFirstReportTimeout && !clock.reports().hasData()) {
    if (choice_ != ClockChoice::ntp) return {};  // they are not required
    found = " sends no RTCP sender reports" + (note.empty() ? "" : " that can be used, but " + note);
  }
  if (found.empty()) return {};
  return nameOf(side) + found +
         ", so exposures are computed from arrival times: connect to the camera itself and synchronise it by "
         "NTP" +
         (choice_ == ClockChoice::ntp ? ", or set cameras.clock: auto" : "");
}

std::string StereoTimestamper::advice() const {
  if (choice_ == ClockChoice::arrival || choice_ == ClockChoice::visual) return {};
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const CameraClockModel& clock = sides_[i].clock;
    if (std::string missing = missingReports(i); !missing.empty()) return missing;
    const double left_out = static_cast<double>(clock.reports().leftOut());
    const double reports = static_cast<double>(clock.reports().reports());
    if (clock.reports().leftOut() >= kMinLeftOut && left_out > kMaxShareLeftOut * reports)
      return nameOf(i) + "'s sender reports contradict each other, and " + fixedText(left_out, 0) + " of " +
             fixedText(reports, 0) + " are left out: let one program alone set its clock, by NTP";
    if (!clock.latencyNs()) continue;
    const double latency_ns = hostLatencyNs(*clock.latencyNs());
    if (!isPlausible(latency_ns))
      return nameOf(i) + "'s clock is " + inSeconds(latency_ns) +
             (latency_ns < 0.0 ? " ahead of" : " behind") +
             " this computer's, so exposures count as late as their packets arrive: synchronise both by NTP";
  }
  return {};
}

/// Why the offset has been uncertain for seconds; empty if it has not.
std::string StereoTimestamper::uncertaintyProblem() const {
  if (uncertain_share_ < kReportedShare) return {};
  const std::string offset = "the time offset between the cameras is ";
  std::array<double, 2> stddevs{};
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const bool is_settled = !sides_[i].connected || sides_[i].clock.pace().isSettled();
    stddevs[i] = is_settled ? sides_[i].clock.arrivals().stddevNs() : kUnsettledStddev_ns;
  }
  const double lag_ns = std::abs(sides_[1].lag_ns - sides_[0].lag_ns);
  if (lag_ns > std::max(stddevs[0], stddevs[1]))
    return offset + "being corrected by " + inSeconds(lag_ns) + ", which takes " +
           inSeconds(lag_ns / kSlewRate) + " more";
  return offset + "uncertain: the pictures of the " +
         sideName(stddevs[0] >= stddevs[1] ? CameraSide::left : CameraSide::right) +
         " camera arrive unevenly; relieve the network and this computer, or set both cameras to one NTP "
         "server";
}

/// Mean latency of the cameras whose reports are plausible against the host's clock, ns; 0 if there are none.
double StereoTimestamper::commonLatencyNs() const {
  double sum = 0.0;
  double count = 0.0;
  for (const Side& side : sides_) {
    const std::optional<std::int64_t> latency_ns = side.clock.latencyNs();
    if (!latency_ns) continue;
    const double latency = hostLatencyNs(*latency_ns);
    if (!isPlausible(latency)) continue;
    sum += latency;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// A latency by the host's wall clock.
double StereoTimestamper::hostLatencyNs(std::int64_t latency_ns) const {
  return static_cast<double>(latency_ns) + host_clock_correction_ns_;
}

/// Computes the exposure of the side's last picture, which arrived at `arrival_ns`.
void StereoTimestamper::advance(Side& side, std::int64_t arrival_ns) {
  const CameraClockModel& clock = side.clock;
  const std::int64_t target_ns = clock.minDelayArrivalNs() + std::llround(side.target_ns);
  const bool continues = side.connected && side.last_epoch == clock.epoch();
  const std::int64_t step_ns = continues ? clock.rtpNs() - side.last_rtp_ns : 0;
  const bool may_jump =
      !continues || !clock.pace().isSettled() || side.last_restarts != clock.arrivals().restarts();
  std::int64_t exposure_ns =
      may_jump || !side.last_exposure_ns ? target_ns : slewedExposureNs(side, target_ns, step_ns);
  // A picture that arrived later was exposed later, unless the host's clock was set back.
  const bool arrived_later = arrival_ns >= side.last_arrival_ns && (!continues || step_ns > 0);
  if (side.last_exposure_ns && arrived_later)
    exposure_ns = std::max(exposure_ns, *side.last_exposure_ns + kMinExposureStep_ns);
  if (continues && side.last_exposure_ns) {
    const std::int64_t own_step_ns =
        step_ns + std::llround(static_cast<double>(step_ns) * clock.arrivals().skew());
    side.slew_ns += exposure_ns - *side.last_exposure_ns - own_step_ns;
  }
  side.lag_ns = static_cast<double>(exposure_ns - target_ns);
  side.last_arrival_ns = arrival_ns;
  side.last_exposure_ns = exposure_ns;
  side.last_rtp_ns = clock.rtpNs();
  side.last_restarts = clock.arrivals().restarts();
  side.last_epoch = clock.epoch();
  side.connected = true;
}

/// The target, limited by the slew rate. A skew that is no crystal's is not limited.
std::int64_t StereoTimestamper::slewedExposureNs(const Side& side, std::int64_t target_ns,
                                                 std::int64_t step_ns) {
  const auto correction_ns = static_cast<double>(target_ns - *side.last_exposure_ns - step_ns);
  const double slew_rate = side.clock.arrivals().isMature() ? kSlewRate : kInitialSlewRate;
  const double nominal_skew =
      std::max(std::abs(side.clock.arrivals().skew()) - ArrivalClockModel::kMaxCrystalSkew, 0.0);
  const double limit_ns = (slew_rate + nominal_skew) * static_cast<double>(std::abs(step_ns));
  return *side.last_exposure_ns + step_ns + std::llround(std::clamp(correction_ns, -limit_ns, limit_ns));
}

ClockStatus StereoTimestamper::status() const {
  const std::lock_guard lock(mutex_);
  ClockStatus status;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const CameraClockModel& clock = sides_[i].clock;
    ClockStatus::Camera& camera = status.cameras[i];
    if (const std::optional<std::int64_t> latency_ns = clock.latencyNs())
      camera.latency_ns = static_cast<double>(*latency_ns);
    camera.skew = clock.arrivals().skew();
    camera.steps = clock.reports().steps();
    camera.left_out = clock.reports().leftOut();
  }
  status.source = source_;
  status.offset = offset_;
  status.ntp = reports_;
  status.visual = visual_;
  status.problem = problem();
  if (status.problem.empty()) status.advice = advice();
  return status;
}

}  // namespace cartvo::capture
