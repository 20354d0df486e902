// Parsing of RTP and RTCP packets, their order, and receiver reports.
#include "capture/rtsp/rtp_packet.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace cartvo::capture {
namespace {

constexpr std::size_t kRtpHeader = 12;
constexpr int kVersion = 2;
constexpr std::uint8_t kSenderReport = 200;
constexpr std::uint8_t kReceiverReport = 201;
constexpr std::uint8_t kSourceDescription = 202;
constexpr std::uint8_t kGoodbye = 203;
constexpr std::int64_t kNtpToUnix_s = 2'208'988'800;  ///< from 1900 to 1970
constexpr std::uint32_t kMaxLost = 0x7fffff;          ///< 24 bits, signed

std::uint32_t read16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) << 8 | bytes[at + 1];
}

std::uint32_t read32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return read16(bytes, at) << 16 | read16(bytes, at + 2);
}

void append32(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0})
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

SenderReport readSenderReport(std::span<const std::uint8_t> part) {
  const std::uint32_t ntp_seconds = read32(part, 8);
  const std::uint32_t fraction = read32(part, 12);
  SenderReport report;
  report.source = read32(part, 4);
  const auto fraction_us =
      static_cast<std::int64_t>((static_cast<std::uint64_t>(fraction) * 1'000'000) >> 32);
  report.instant_us = (static_cast<std::int64_t>(ntp_seconds) - kNtpToUnix_s) * 1'000'000 + fraction_us;
  report.timestamp = read32(part, 16);
  report.ntp_middle = ntp_seconds << 16 | fraction >> 16;
  return report;
}

// RFC 3550, A.1.
constexpr std::int64_t kMaxDropout = 3000;
constexpr std::int64_t kMaxMisorder = 1000;
constexpr int kOutOfRangeOfARestart = 2;

// Numbers that are skipped before more than each eighth packet are a habit: after eight such packets in a
// row, or some twenty of which every other one is.
constexpr int kSkip = 8;
constexpr int kSkippingOfAHabit = 64;

}  // namespace

std::optional<RtpPacket> parseRtpPacket(std::span<const std::uint8_t> packet) {
  if (packet.size() < kRtpHeader || packet[0] >> 6 != kVersion) return std::nullopt;
  std::size_t begin = kRtpHeader + 4 * static_cast<std::size_t>(packet[0] & 0x0f);  // contributing sources
  std::size_t end = packet.size();
  const bool has_extension = (packet[0] & 0x10) != 0;
  if (has_extension && begin + 4 > end) return std::nullopt;
  if (has_extension) begin += 4 + 4 * static_cast<std::size_t>(read16(packet, begin + 2));
  const bool has_padding = (packet[0] & 0x20) != 0;
  if (has_padding) end -= std::min<std::size_t>(packet.back(), end);
  if (begin > end) return std::nullopt;
  RtpPacket result;
  result.payload = packet.subspan(begin, end - begin);
  result.marker = (packet[1] & 0x80) != 0;
  result.payload_type = packet[1] & 0x7f;
  result.sequence = static_cast<std::uint16_t>(read16(packet, 2));
  result.timestamp = read32(packet, 4);
  result.source = read32(packet, 8);
  return result;
}

bool isRtcp(std::span<const std::uint8_t> packet) {
  constexpr std::uint8_t kFirst = 192,
                         kLast = 223;  // with the marker bit, payload types that RTP must not use
  return packet.size() >= 4 && packet[0] >> 6 == kVersion && packet[1] >= kFirst && packet[1] <= kLast;
}

RtcpContent parseRtcp(std::span<const std::uint8_t> packet) {
  RtcpContent content;
  constexpr std::size_t kSenderInfo = 28;
  while (packet.size() >= 4 && packet[0] >> 6 == kVersion) {
    const std::size_t length = 4 * (static_cast<std::size_t>(read16(packet, 2)) + 1);
    if (length > packet.size()) break;
    const std::span<const std::uint8_t> part = packet.first(length);
    if (part[1] == kSenderReport && length < kSenderInfo) break;
    if (part[1] == kSenderReport) content.reports.push_back(readSenderReport(part));
    if (part[1] == kGoodbye && length >= 8) content.ended_source = read32(part, 4);
    packet = packet.subspan(length);
  }
  content.is_whole = packet.empty();
  return content;
}

std::vector<std::uint8_t> receiverReportPacket(const ReceiverReport& report) {
  std::vector<std::uint8_t> packet = {0x81, kReceiverReport, 0, 7};  // one block
  append32(packet, report.receiver);
  append32(packet, report.source);
  append32(packet, std::min(report.lost, kMaxLost));  // the fraction lost is not reported
  append32(packet, report.highest_sequence);
  append32(packet, 0);  // jitter is not reported
  append32(packet, report.last_report);
  append32(packet, report.since_last_report);
  constexpr std::string_view kName = "cartvo";
  packet.insert(packet.end(), {0x81, kSourceDescription, 0, 4});
  append32(packet, report.receiver);
  packet.push_back(1);  // CNAME
  packet.push_back(static_cast<std::uint8_t>(kName.size()));
  packet.insert(packet.end(), kName.begin(), kName.end());
  packet.insert(packet.end(), 12 - 2 - kName.size(), 0);  // the end of the list, and padding to 32 bits
  return packet;
}

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
