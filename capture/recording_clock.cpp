#include "capture/recording_clock.hpp"

namespace cartvo {
namespace {

/// A camera that falls silent for hours leaves the other's instants waiting; beyond that the oldest go.
constexpr std::size_t kMostWaiting = 1U << 20;

}  // namespace

RecordingClock::RecordingClock(const std::filesystem::path& recording, ClockChoice choice)
    : clock_(choice),
      sides_{Side(RecordedRows(recording, CameraSide::left)),
             Side(RecordedRows(recording, CameraSide::right))} {}

/// Stamps the picture that came next, of whichever camera. False at the end of both.
bool RecordingClock::stampNext() {
  const IndexRow* left = sides_[0].next;
  const IndexRow* right = sides_[1].next;
  if (left == nullptr && right == nullptr) return false;
  const bool is_left = right == nullptr || (left != nullptr && left->order < right->order);
  const CameraSide which = is_left ? CameraSide::left : CameraSide::right;
  Side& side = sides_[static_cast<std::size_t>(which)];
  const IndexRow& row = *side.next;
  if (row.connection != side.connection) clock_.connect(which);
  side.connection = row.connection;
  const StampedInstant instant = clock_.stamp(which, {row.pts, row.reference_us, row.first_arrival_ns});
  side.waiting.push_back({row.order, instant});
  if (side.waiting.size() > kMostWaiting) side.waiting.pop_front();
  side.next = side.rows.next();
  return true;
}

std::optional<StampedInstant> RecordingClock::stamp(CameraSide which, std::uint64_t order) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  for (;;) {
    while (!side.waiting.empty() && side.waiting.front().order < order)
      side.waiting.pop_front();
    if (!side.waiting.empty()) break;
    if (!stampNext()) return std::nullopt;
  }
  if (side.waiting.front().order != order) return std::nullopt;
  const StampedInstant instant = side.waiting.front().instant;
  side.waiting.pop_front();
  return instant;
}

}  // namespace cartvo
