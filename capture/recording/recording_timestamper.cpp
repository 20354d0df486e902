// Time stamps of recorded pictures, computed again from the recording's indices.

#include "capture/recording/recording_timestamper.hpp"

namespace cartvo::capture {
namespace {

/// Time stamps that wait while the other camera sends nothing, several hours of them; the oldest are dropped.
constexpr std::size_t kMaxWaiting = 1U << 20;

}  // namespace

RecordingTimestamper::RecordingTimestamper(const std::filesystem::path& recording, ClockChoice choice)
    : timestamper_(choice),
      sides_{Side(RecordingIndexReader(recording, CameraSide::left)),
             Side(RecordingIndexReader(recording, CameraSide::right))} {}

/// Timestamps the picture that arrived next, of either camera. False at the end of both.
bool RecordingTimestamper::stampNext() {
  const IndexRow* left = sides_[0].next;
  const IndexRow* right = sides_[1].next;
  if (left == nullptr && right == nullptr) return false;
  const bool is_left = right == nullptr || (left != nullptr && left->order < right->order);
  const CameraSide which = is_left ? CameraSide::left : CameraSide::right;
  Side& side = sides_[static_cast<std::size_t>(which)];
  const IndexRow& row = *side.next;
  if (row.connection != side.connection) timestamper_.connect(which);
  side.connection = row.connection;
  const ExposureTimestamp timestamp =
      timestamper_.stamp(which, {row.pts, row.reference_us, row.first_arrival_ns});
  side.waiting.push_back({row.order, timestamp});
  if (side.waiting.size() > kMaxWaiting) side.waiting.pop_front();
  side.next = side.rows.next();
  return true;
}

std::optional<ExposureTimestamp> RecordingTimestamper::stamp(CameraSide which, std::uint64_t order) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  for (;;) {
    while (!side.waiting.empty() && side.waiting.front().order < order)
      side.waiting.pop_front();
    if (!side.waiting.empty()) break;
    if (!stampNext()) return std::nullopt;
  }
  if (side.waiting.front().order != order) return std::nullopt;
  const ExposureTimestamp timestamp = side.waiting.front().timestamp;
  side.waiting.pop_front();
  return timestamp;
}

}  // namespace cartvo::capture
