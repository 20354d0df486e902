// Parsing of RTP and RTCP packets, and receiver reports.

#include "capture/rtsp/rtp_packet.hpp"

#include <algorithm>
#include <string_view>

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

}  // namespace cartvo::capture
