// Order of RTP packets by sequence number.

#include "capture/rtsp/rtp_sequencer.hpp"

#include <algorithm>
#include <utility>

namespace cartvo::capture {
namespace {

// RFC 3550, A.1.
constexpr std::int64_t kMaxDropout = 3000;
constexpr std::int64_t kMaxMisorder = 1000;
constexpr int kOutOfRangeOfARestart = 2;

// Numbers that are skipped before more than each eighth packet are a habit: after eight such packets in a
// row, or some twenty of which every other one is.
constexpr int kSkip = 8;
constexpr int kSkippingOfAHabit = 64;

}  // namespace

/// Begins a new sequence: the first one, a new sender, or numbers that have jumped.
void RtpSequencer::restart(const RtpPacket& header) {
  gap_ = source_.has_value();
  source_ = header.source;
  next_ = header.sequence;
  left_out_ += waiting_.size();
  waiting_.clear();
  out_of_range_ = 0;
}

void RtpSequencer::add(const RtpPacket& header, SequencedPacket packet) {
  if (window_ == 0) return addInOrder(header, std::move(packet));
  newest_arrival_ns_ = packet.arrival_ns;
  if (source_ != header.source) restart(header);
  const auto ahead =
      static_cast<std::int16_t>(header.sequence - static_cast<std::uint16_t>(next_));  // nearest
  if (ahead > kMaxDropout || ahead < -kMaxMisorder) {
    if (++out_of_range_ < kOutOfRangeOfARestart) {
      ++left_out_;
      return;
    }
    restart(header);
    waiting_.emplace(next_, std::move(packet));
    return;
  }
  out_of_range_ = 0;
  const bool is_new = ahead >= 0 && waiting_.emplace(next_ + ahead, std::move(packet)).second;
  if (!is_new) ++left_out_;  // late, or a duplicate
}

/// Adds a packet of a transport that keeps the order. Numbers that go back or begin anew are no loss. Numbers
/// that are missing are one (a sender leaves packets out where its connection is congested), unless they are
/// always missing: some senders count the packets of another stream, too.
void RtpSequencer::addInOrder(const RtpPacket& header, SequencedPacket packet) {
  const auto ahead = static_cast<std::int16_t>(header.sequence - static_cast<std::uint16_t>(next_));
  const bool continues = source_ == header.source && ahead >= 0 && ahead <= kMaxDropout;
  if (continues) {
    const bool is_habit = skipping_ >= kSkippingOfAHabit;
    skipping_ = ahead > 0 ? std::min(skipping_ + kSkip, 2 * kSkippingOfAHabit) : std::max(skipping_ - 1, 0);
    if (ahead > 0 && !is_habit) {
      lost_ += static_cast<std::uint64_t>(ahead);
      packet.data_lost = true;
    }
  }
  source_ = header.source;
  next_ = continues ? next_ + ahead + 1 : std::int64_t{header.sequence} + 1;
  waiting_.emplace(arrivals_++, std::move(packet));
}

std::optional<SequencedPacket> RtpSequencer::pop() {
  if (waiting_.empty()) return std::nullopt;
  auto first = waiting_.begin();
  if (window_ == 0) {
    SequencedPacket packet = std::move(first->second);
    waiting_.erase(first);
    return packet;
  }
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
