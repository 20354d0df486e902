#include "capture/pair_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace cartvo {
namespace {

// Standard deviations of what each witness takes for granted, ns.
constexpr double kLatencyAgreement_ns = 1e6;  // two cameras of one model and settings, at their quickest
constexpr double kNtpAgreement_ns = 1e6;      // two clocks that follow one time server in the same network

constexpr double kRefuted = 3.0;  // standard deviations
constexpr double kTellingDisagreement_ns = 5e6;
constexpr double kUndecided_ns = 20e6;  // a camera may be slower than the other by less than that

constexpr double kSlewing = 0.005;      // of the time that passes
constexpr double kFirstSlewing = 0.25;  // in a connection's first seconds
constexpr double kClockSet_ns = 500e6;  // beyond it the host's clock was set: that is followed at once
constexpr std::int64_t kLeastStep_ns = 1'000'000;

constexpr double kFirstReportIsDue = 15.0;  // s; cameras send their reports each few seconds

constexpr double kLeastLatency_ns = -50e6;  // what two clocks may differ by
constexpr double kLongestLatency_ns = 3e9;

/// Of a report, while there are too few to tell. Who chooses the cameras' clocks vouches for their reports;
/// else they may be stamped when they are sent.
double usualScatterNs(ClockChoice choice) {
  return choice == ClockChoice::ntp ? 1e6 : 20e6;
}

double square(double value) {
  return value * value;
}

bool agree(const ClockWitness& a, const ClockWitness& b) {
  return std::abs(a.value_ns - b.value_ns) <= kRefuted * std::hypot(a.deviation_ns, b.deviation_ns);
}

/// The mean, weighted by the variances; its deviation is widened where they scatter by more than they say.
ClockWitness mean(const std::vector<ClockWitness>& witnesses) {
  double weight = 0.0;
  double sum = 0.0;
  for (const ClockWitness& w : witnesses) {
    weight += 1.0 / square(w.deviation_ns);
    sum += w.value_ns / square(w.deviation_ns);
  }
  const double value = sum / weight;
  double chi_square = 0.0;
  for (const ClockWitness& w : witnesses)
    chi_square += square((w.value_ns - value) / w.deviation_ns);
  const double excess = chi_square / std::max(static_cast<double>(witnesses.size()) - 1.0, 1.0);
  return {value, std::sqrt(std::max(excess, 1.0) / weight)};
}

std::string inSeconds(double nanoseconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", std::abs(nanoseconds) * 1e-9);
  return text;
}

}  // namespace

PairClock::PairClock(ClockChoice choice)
    : choice_(choice), sides_{Side(usualScatterNs(choice)), Side(usualScatterNs(choice))} {}

void PairClock::connect(CameraSide which) {
  const std::lock_guard lock(mutex_);
  Side& side = sides_[static_cast<std::size_t>(which)];
  side.clock.connect();
  side.connected = false;
}

StampedInstant PairClock::stamp(CameraSide which, const StampedPacket& packet) {
  const std::lock_guard lock(mutex_);
  Side& side = sides_[static_cast<std::size_t>(which)];
  side.clock.add(packet);
  relate();
  const std::int64_t exposure_ns = slewed(side, packet.arrival_ns);
  const double deviation = std::hypot(offset_.deviation_ns, sides_[1].lag_ns - sides_[0].lag_ns);
  return {exposure_ns, std::llround(deviation / std::sqrt(2.0)), side.clock.undelayedArrivalNs(), source_};
}

void PairClock::setVisual(const std::optional<ClockWitness>& offset) {
  const std::lock_guard lock(mutex_);
  visual_ = offset;
}

/// Where both cameras' exposures should lie against their undelayed arrivals.
void PairClock::relate() {
  const ClockWitness arrival = byArrival();
  reports_ = byReports();
  choose(arrival);
  const double latency = choice_ == ClockChoice::arrival ? 0.0 : commonLatencyNs();
  sides_[0].target_ns = -latency - 0.5 * offset_.value_ns;
  sides_[1].target_ns = -latency + 0.5 * offset_.value_ns;
}

ClockWitness PairClock::byArrival() const {
  double variance = square(kLatencyAgreement_ns);
  for (const Side& side : sides_)
    variance += square(side.clock.arrivals().deviationNs());
  return {0.0, std::sqrt(variance)};
}

/// Nothing unless each camera that is there has reported; of a camera alone, that it has.
std::optional<ClockWitness> PairClock::byReports() const {
  std::array<double, 2> latencies{};
  double variance = square(kNtpAgreement_ns);
  bool both = true;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const StreamClock& clock = sides_[i].clock;
    const std::optional<std::int64_t> latency_ns = clock.latencyNs();
    if (!latency_ns && sides_[i].connected) return std::nullopt;
    if (latency_ns) variance += square(clock.reportedDeviationNs());
    latencies[i] = static_cast<double>(latency_ns.value_or(0));
    both = both && latency_ns;
  }
  if (!both && !sides_[0].connected && !sides_[1].connected) return std::nullopt;
  return ClockWitness{both ? latencies[0] - latencies[1] : 0.0, std::sqrt(variance)};
}

void PairClock::choose(const ClockWitness& arrival) {
  const std::optional<ClockWitness>& better =
      choice_ == ClockChoice::automatic || choice_ == ClockChoice::visual ? visual_ : std::nullopt;
  reports_count_ = reports_ && agree(*reports_, better.value_or(arrival));
  offset_ = arrival;
  source_ = InstantSource::arrival;
  switch (choice_) {
    case ClockChoice::automatic:
      return combine(arrival);
    case ClockChoice::ntp:
      if (!reports_ || std::abs(reports_->value_ns) > kClockSet_ns) return;
      reports_count_ = true;
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

void PairClock::combine(const ClockWitness& arrival) {
  std::vector<ClockWitness> witnesses;
  if (!visual_ || agree(arrival, *visual_)) witnesses.push_back(arrival);
  if (reports_count_) witnesses.push_back(*reports_);
  if (visual_) witnesses.push_back(*visual_);
  offset_ = mean(witnesses);
  if (visual_) {
    source_ = InstantSource::pictures;
  } else if (reports_count_) {
    source_ = InstantSource::sender_report;
  } else if (reports_ && std::abs(reports_->value_ns) < kUndecided_ns) {
    // Clocks that disagree, or latencies that do: nobody knows.
    offset_.deviation_ns = std::max(offset_.deviation_ns, 0.5 * std::abs(reports_->value_ns));
  }
}

std::string PairClock::problem() const {
  for (std::size_t i = 0; choice_ == ClockChoice::ntp && i < sides_.size(); ++i) {
    const StreamClock& clock = sides_[i].clock;
    if (clock.seconds() < kFirstReportIsDue || clock.reports().known()) continue;
    return std::string("the ") + (i == 0 ? "left" : "right") +
           " camera sends no RTCP sender reports, so exposures rest on arrival: connect to the camera itself "
           "and let it keep time by NTP, or set cameras.clock: auto";
  }
  const bool reports_matter = choice_ == ClockChoice::automatic || choice_ == ClockChoice::ntp;
  if (!reports_matter || !reports_ || reports_count_) return {};
  const double difference = reports_->value_ns - offset_.value_ns;
  if (std::abs(difference) < kTellingDisagreement_ns) return {};
  return "the cameras' clocks disagree by " + inSeconds(difference) +
         ": let both keep time by NTP, from one server near them; meanwhile exposures rest on " +
         (source_ == InstantSource::pictures ? "the pictures" : "arrival");
}

/// Of the cameras whose reports make sense on the host's clock, ns.
double PairClock::commonLatencyNs() const {
  double sum = 0.0;
  double count = 0.0;
  for (const Side& side : sides_) {
    const std::optional<std::int64_t> latency_ns = side.clock.latencyNs();
    if (!latency_ns) continue;
    const auto latency = static_cast<double>(*latency_ns);
    if (latency < kLeastLatency_ns || latency > kLongestLatency_ns) continue;
    sum += latency;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// The exposure of the side's last picture, which arrived at `arrival_ns`, as far towards its target as a
/// clock may be slewed.
std::int64_t PairClock::slewed(Side& side, std::int64_t arrival_ns) {
  const StreamClock& clock = side.clock;
  const std::int64_t target_ns = clock.undelayedArrivalNs() + std::llround(side.target_ns);
  const bool clock_was_set = !side.connected || side.last_restarts != clock.arrivals().restarts();
  std::int64_t exposure_ns = target_ns;
  if (side.last_exposure_ns) {
    const std::int64_t step_ns = side.connected ? clock.rtpNs() - side.last_rtp_ns : 0;
    const auto miss = static_cast<double>(target_ns - *side.last_exposure_ns - step_ns);
    if (!side.connected && miss > 0.0) {
      exposure_ns = target_ns;  // time went on between two connections
    } else if (!clock_was_set || std::abs(miss) <= kClockSet_ns) {
      const double share = clock.arrivals().settled() ? kSlewing : kFirstSlewing;
      const double most = share * static_cast<double>(std::abs(step_ns));
      exposure_ns = *side.last_exposure_ns + step_ns + std::llround(std::clamp(miss, -most, most));
      if (!side.connected) exposure_ns += kLeastStep_ns;
    }
  }
  // Whatever the camera says: what came later was exposed later, unless the host's clock was set back.
  const bool is_later =
      arrival_ns >= side.last_arrival_ns && (!side.connected || clock.rtpNs() > side.last_rtp_ns);
  if (side.last_exposure_ns && is_later)
    exposure_ns = std::max(exposure_ns, *side.last_exposure_ns + kLeastStep_ns);
  side.lag_ns = static_cast<double>(exposure_ns - target_ns);
  side.last_arrival_ns = arrival_ns;
  side.last_exposure_ns = exposure_ns;
  side.last_rtp_ns = clock.rtpNs();
  side.last_restarts = clock.arrivals().restarts();
  side.connected = true;
  return exposure_ns;
}

ClockStatus PairClock::status() const {
  const std::lock_guard lock(mutex_);
  ClockStatus status;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const StreamClock& clock = sides_[i].clock;
    ClockStatus::Camera& camera = status.cameras[i];
    if (const std::optional<std::int64_t> latency_ns = clock.latencyNs())
      camera.latency_ns = static_cast<double>(*latency_ns);
    camera.skew = clock.arrivals().skew();
    camera.steps = clock.reports().steps();
  }
  status.source = source_;
  status.offset = offset_;
  status.ntp = reports_;
  status.visual = visual_;
  status.problem = problem();
  return status;
}

}  // namespace cartvo
