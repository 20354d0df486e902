// Passes pairs from the cameras' threads to the odometry's thread; keeps only the newest.

#include "pipeline/live_pairing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "common/image_size.hpp"

namespace cartvo::pipeline {
namespace {

constexpr std::size_t kArrivals = 64;
constexpr std::size_t kMinArrivals = 5;
constexpr std::int64_t kMaxUnpaired_ns = 5'000'000'000;  // a camera that sends nothing is reconnected by then
constexpr std::uint64_t kMinUnpaired = 5;                // frames of each camera since the latest pair

/// Mean interval without the longest one, in which the connection may have been lost; 0 until it is known.
std::int64_t meanInterval(const std::deque<std::int64_t>& instants) {
  if (instants.size() < kMinArrivals) return 0;
  std::int64_t longest = 0;
  for (std::size_t i = 1; i < instants.size(); ++i)
    longest = std::max(longest, instants[i] - instants[i - 1]);
  return (instants.back() - instants.front() - longest) / static_cast<std::int64_t>(instants.size() - 2);
}

/// How many pictures arrive at a time, if at least kMinTogether do and not for once, as after a pause of this
/// process; else nothing.
std::optional<std::size_t> picturesAtATime(const std::deque<std::int64_t>& arrivals) {
  constexpr std::size_t kMinTogether = 4, kMinBursts = 2;
  const std::int64_t mean_ns = meanInterval(arrivals);
  std::size_t together = 1, bursts = 0, in_bursts = 0;
  for (std::size_t i = 1; i < arrivals.size(); ++i) {
    const std::int64_t interval_ns = arrivals[i] - arrivals[i - 1];
    const bool ends_burst = interval_ns > mean_ns && together >= kMinTogether;
    if (ends_burst) ++bursts, in_bursts += together;
    together = interval_ns < mean_ns / 4 ? together + 1 : 1;
  }
  return bursts >= kMinBursts ? std::optional(in_bursts / bursts) : std::nullopt;
}

}  // namespace

PairingTotals totals(const capture::PairSynchroniser& synchroniser) {
  const capture::PairingCounts& left = synchroniser.counts(capture::CameraSide::left);
  const capture::PairingCounts& right = synchroniser.counts(capture::CameraSide::right);
  PairingTotals sum;
  sum.pairs = left.paired;
  sum.frames.received = left.received + right.received;
  sum.frames.paired = left.paired + right.paired;
  sum.frames.no_partner = left.no_partner + right.no_partner;
  sum.frames.damaged = left.damaged + right.damaged;
  sum.frames.out_of_order = left.out_of_order + right.out_of_order;
  sum.frames.overflow = left.overflow + right.overflow;
  sum.frames.clock_restarted = left.clock_restarted + right.clock_restarted;
  return sum;
}

std::string wrongSizeMessage(capture::CameraSide side, cv::Size stream, cv::Size rig) {
  return std::string(capture::sideName(side)) + " camera: the stream is " + sizeText(stream) +
         ", but the rig is for " + sizeText(rig) +
         "; set the camera to the rig's resolution, or calibrate at the stream's (a camera may crop instead "
         "of scale)";
}

LivePairing::LivePairing(const capture::PairSynchroniserSettings& settings, cv::Size image_size)
    : synchroniser_(settings), image_size_(image_size) {}

void LivePairing::push(capture::CameraSide which, capture::Frame frame) {
  const std::lock_guard lock(mutex_);
  Side& side = sides_[static_cast<std::size_t>(which)];
  if (frame.image.size() != image_size_) {
    side.refused = frame.image.size();
    ++refused_size_;
    return;
  }
  side.refused.reset();
  side.exposure_ns = frame.exposure_ns;
  side.arrivals.push_back(frame.arrival_ns);
  if (side.arrivals.size() > kArrivals) side.arrivals.pop_front();
  if (!last_pair_ns_) last_pair_ns_ = frame.arrival_ns;
  synchroniser_.push(which, std::move(frame));
  while (std::optional<capture::FramePair> pair = synchroniser_.pop()) {
    if (newest_) ++skipped_;
    newest_ = std::move(pair);
    last_pair_ns_ = side.arrivals.back();
    for (const capture::CameraSide each : {capture::CameraSide::left, capture::CameraSide::right})
      sides_[static_cast<std::size_t>(each)].before_pair = synchroniser_.counts(each);
  }
  if (newest_) changed_.notify_one();
}

void LivePairing::finish(capture::CameraSide which) {
  const std::lock_guard lock(mutex_);
  synchroniser_.finish(which);
  sides_[static_cast<std::size_t>(which)].finished = true;
  changed_.notify_one();
}

std::optional<capture::FramePair> LivePairing::waitForPair(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [this] { return newest_.has_value() || bothFinished(); });
  return std::exchange(newest_, std::nullopt);
}

bool LivePairing::finished() const {
  const std::lock_guard lock(mutex_);
  return bothFinished() && !newest_;
}

LivePairing::Counts LivePairing::counts() const {
  const std::lock_guard lock(mutex_);
  return {totals(synchroniser_), skipped_, refused_size_};
}

FramePeriods LivePairing::periods() const {
  const std::lock_guard lock(mutex_);
  FramePeriods periods;
  for (const capture::CameraSide which : {capture::CameraSide::left, capture::CameraSide::right}) {
    const auto i = static_cast<std::size_t>(which);
    periods.by_exposures[i] = synchroniser_.framePeriodNs(which);
    periods.by_arrivals[i] = meanInterval(sides_[i].arrivals);
  }
  return periods;
}

std::string LivePairing::problem() const {
  const std::lock_guard lock(mutex_);
  for (const capture::CameraSide which : {capture::CameraSide::left, capture::CameraSide::right})
    if (side(which).refused) return wrongSizeMessage(which, *side(which).refused, image_size_);
  return {};
}

std::string LivePairing::pairingProblem() const {
  const std::lock_guard lock(mutex_);
  for (const capture::CameraSide which : {capture::CameraSide::left, capture::CameraSide::right}) {
    const std::optional<std::size_t> together = picturesAtATime(side(which).arrivals);
    if (!together) continue;
    return std::string("the ") + capture::sideName(which) + " camera's pictures arrive " +
           std::to_string(*together) +
           " at a time, so that most are skipped or come too late: connect to the camera itself, without a "
           "re-streamer, and relieve its network";
  }
  std::int64_t latest_ns = 0;
  for (const capture::CameraSide which : {capture::CameraSide::left, capture::CameraSide::right}) {
    const std::uint64_t received = synchroniser_.counts(which).received;
    if (received < side(which).before_pair.received + kMinUnpaired) return {};
    latest_ns = std::max(latest_ns, side(which).arrivals.back());
  }
  if (latest_ns - *last_pair_ns_ < kMaxUnpaired_ns) return {};
  for (const capture::CameraSide which : {capture::CameraSide::left, capture::CameraSide::right}) {
    const capture::PairingCounts& now = synchroniser_.counts(which);
    const capture::PairingCounts& before = side(which).before_pair;
    const std::string camera =
        std::string("no pictures can be paired: the ") + capture::sideName(which) + " camera's ";
    const std::uint64_t half = (now.received - before.received) / 2;
    if (now.damaged - before.damaged > half)
      return camera + "are damaged: data are lost on its network, or its RTP times are wrong";
    if (now.out_of_order - before.out_of_order > half)
      return camera + "are not in the order of their times: switch it off and on";
  }
  const double apart = static_cast<double>(sides_[1].exposure_ns - sides_[0].exposure_ns) * 1e-6;
  return "no pictures can be paired: the right camera's latest is " +
         std::to_string(std::llround(std::abs(apart))) + " ms " + (apart < 0.0 ? "before" : "after") +
         " the left one's; switch the one that is late off and on, and let both keep time by NTP";
}

}  // namespace cartvo::pipeline
