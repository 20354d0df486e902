// Pairing of two cameras' frames by their exposure instants, live and of sources that end.
#include "capture/pair_synchroniser.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace cartvo::capture {
namespace {

// Margin beyond half a period up to which the partner is kept. A change of the partner drops a frame, so that
// a whole period passes without a pair, whereas a kept partner costs only the margin in the offset.
constexpr double kMarginStddevs = 3.0;  // of the offset: its error does not change the partner
// At least an eighth of the period: the other frame is nearer by a quarter of the period then, which jitter
// of exposures whose instants are known exactly does not reach.
constexpr std::int64_t kMinMarginDivisor = 8;
// At most a quarter: the other frame is nearer by half a period then.
constexpr std::int64_t kMaxMarginDivisor = 4;

double offsetStddevNs(const Frame& left, const Frame& right) {
  return std::hypot(static_cast<double>(left.exposure_stddev_ns),
                    static_cast<double>(right.exposure_stddev_ns));
}

/// Time that a source waits for a frame before it is asked again.
constexpr std::chrono::milliseconds kReadTimeout{200};

/// Order of two frames: of recording, which does not depend on clocks; where it is unknown, of exposure.
bool comesFirst(const Frame& left, const Frame& right) {
  if (left.order > 0 && right.order > 0) return left.order < right.order;
  return left.exposure_ns <= right.exposure_ns;
}

}  // namespace

double FramePair::offsetStddevNs() const {
  return capture::offsetStddevNs(left, right);
}

PairSynchroniser::PairSynchroniser(const PairSynchroniserSettings& settings) : settings_(settings) {
  if (settings.period_ns < 0) throw std::invalid_argument("pairing: period_ns must not be negative");
  if (settings.queue_length < 1) throw std::invalid_argument("pairing: queue_length must be at least 1");
  if (settings.restart_after < 1) throw std::invalid_argument("pairing: restart_after must be at least 1");
}

void PairSynchroniser::push(CameraSide which, Frame frame) {
  Side& side = sides_[index(which)];
  ++side.counts.received;
  if (!accept(side, frame)) {
    ++side.counts.out_of_order;
    return;
  }
  side.period.add(frame.exposure_ns - frame.slew_ns);
  if (frame.status == FrameStatus::damaged) {
    ++side.counts.damaged;
    return;
  }
  side.waiting.push_back(std::move(frame));
  if (side.waiting.size() > settings_.queue_length) drop(side, &PairingCounts::overflow);
}

/// Whether the frame is later than the last accepted one. `restart_after` consecutive frames that are
/// earlier, in order among themselves, mean that the clock was set back: the sequence restarts with them.
bool PairSynchroniser::accept(Side& side, const Frame& frame) {
  if (!side.last_ns || frame.exposure_ns > *side.last_ns) {
    side.last_ns = frame.exposure_ns;
    side.backward_in_row = 0;
    return true;
  }
  const bool continues = side.backward_in_row > 0 && frame.exposure_ns > side.last_backward_ns;
  side.backward_in_row = continues ? side.backward_in_row + 1 : 1;
  side.last_backward_ns = frame.exposure_ns;
  if (side.backward_in_row < settings_.restart_after) return false;
  restart(side, frame);
  return true;
}

void PairSynchroniser::restart(Side& side, const Frame& frame) {
  while (!side.waiting.empty())
    drop(side, &PairingCounts::clock_restarted);
  side.period.restart();
  last_offset_ns_.reset();
  side.last_ns = frame.exposure_ns;
  side.backward_in_row = 0;
}

std::optional<FramePair> PairSynchroniser::pop() {
  Side& left = sides_[index(CameraSide::left)];
  Side& right = sides_[index(CameraSide::right)];
  const std::int64_t period = periodNs();
  while (!left.waiting.empty() && !right.waiting.empty()) {
    const std::int64_t offset = right.waiting.front().exposure_ns - left.waiting.front().exposure_ns;
    Side& older = offset >= 0 ? left : right;
    if (std::abs(offset) <= maximumOffsetNs(period)) {
      last_offset_ns_ = offset;
      FramePair pair{std::move(left.waiting.front()), std::move(right.waiting.front())};
      left.waiting.pop_front();
      right.waiting.pop_front();
      ++left.counts.paired;
      ++right.counts.paired;
      return pair;
    }
    const bool period_is_unknown = period == 0 && !left.finished && !right.finished;
    if (period_is_unknown) return std::nullopt;
    drop(older, &PairingCounts::no_partner);
  }
  if (right.finished && right.waiting.empty()) {
    while (!left.waiting.empty())
      drop(left, &PairingCounts::no_partner);
  }
  if (left.finished && left.waiting.empty()) {
    while (!right.waiting.empty())
      drop(right, &PairingCounts::no_partner);
  }
  return std::nullopt;
}

/// Maximum offset of a pair of the two waiting frames, ns.
std::int64_t PairSynchroniser::maximumOffsetNs(std::int64_t period) const {
  const Frame& left = sides_[index(CameraSide::left)].waiting.front();
  const Frame& right = sides_[index(CameraSide::right)].waiting.front();
  const std::int64_t half = period / 2;
  // Another frame would be the partner if the offset had changed by more than half a period.
  const std::int64_t offset = right.exposure_ns - left.exposure_ns;
  if (!last_offset_ns_ || std::abs(offset - *last_offset_ns_) > half) return half;
  const auto uncertainty = std::llround(kMarginStddevs * offsetStddevNs(left, right));
  return half + std::clamp(static_cast<std::int64_t>(uncertainty), period / kMinMarginDivisor,
                           period / kMaxMarginDivisor);
}

void PairSynchroniser::finish(CameraSide side) {
  sides_[index(side)].finished = true;
}

std::int64_t PairSynchroniser::periodNs() const {
  if (settings_.period_ns > 0) return settings_.period_ns;
  const std::int64_t left = sides_[0].period.periodNs();
  const std::int64_t right = sides_[1].period.periodNs();
  // The camera with the higher frame rate limits the offset.
  return left == 0 || right == 0 ? 0 : std::min(left, right);
}

void PairSynchroniser::drop(Side& side, std::uint64_t PairingCounts::*reason) {
  side.waiting.pop_front();
  ++(side.counts.*reason);
}

void PairReader::LookAhead::fill() {
  while (!frame && !ended) {
    Frame next;
    const ReadOutcome outcome = source.read(next, kReadTimeout);
    if (outcome == ReadOutcome::frame) frame = std::move(next);
    ended = outcome == ReadOutcome::ended;
  }
}

PairReader::PairReader(CameraSource& left, CameraSource& right, const PairSynchroniserSettings& settings)
    : left_{left}, right_{right}, synchroniser_(settings) {}

std::optional<FramePair> PairReader::next() {
  for (;;) {
    if (std::optional<FramePair> pair = synchroniser_.pop()) return pair;
    left_.fill();
    right_.fill();
    if (!left_.frame && !right_.frame) return std::nullopt;
    const bool left_is_next = !right_.frame || (left_.frame && comesFirst(*left_.frame, *right_.frame));
    LookAhead& side = left_is_next ? left_ : right_;
    synchroniser_.push(left_is_next ? CameraSide::left : CameraSide::right,
                       *std::exchange(side.frame, std::nullopt));
  }
}

}  // namespace cartvo::capture
