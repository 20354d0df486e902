// Order of RTP packets by sequence number.

#include "capture/rtsp/rtp_sequencer.hpp"

#include <utility>

namespace cartvo::capture {
namespace {

// RFC 3550, A.1.
constexpr std::int64_t kMaxDropout = 3000;
constexpr std::int64_t kMaxMisorder = 1000;
constexpr int kOutOfRangeOfARestart = 2;

}  // namespace

/// Begins a new sequence: the first one, a new sender, or numbers that have jumped.
void RtpSequencer::restart(const RtpPacket& header) {
  gap_ = source_.has_value();
  source_ = header.source;
  next_ = header.sequence;
  waiting_.clear();
  out_of_range_ = 0;
}

void RtpSequencer::add(const RtpPacket& header, SequencedPacket packet) {
  newest_arrival_ns_ = packet.arrival_ns;
  if (source_ != header.source) restart(header);
  const auto ahead =
      static_cast<std::int16_t>(header.sequence - static_cast<std::uint16_t>(next_));  // nearest
  if (ahead > kMaxDropout || ahead < -kMaxMisorder) {
    if (++out_of_range_ < kOutOfRangeOfARestart) return;
    restart(header);
    waiting_.emplace(next_, std::move(packet));
    return;
  }
  out_of_range_ = 0;
  if (ahead >= 0) waiting_.emplace(next_ + ahead, std::move(packet));  // else late, or a duplicate
}

std::optional<SequencedPacket> RtpSequencer::pop() {
  if (waiting_.empty()) return std::nullopt;
  auto first = waiting_.begin();
  if (first->first != next_) {
    const bool patient =
        waiting_.size() <= window_ && newest_arrival_ns_ - first->second.arrival_ns <= patience_ns_;
    if (patient) return std::nullopt;
    lost_ += static_cast<std::uint64_t>(first->first - next_);
    gap_ = true;
  }
  SequencedPacket packet = std::move(first->second);
  next_ = first->first + 1;
  waiting_.erase(first);
  packet.data_lost = std::exchange(gap_, false);
  return packet;
}

}  // namespace cartvo::capture
