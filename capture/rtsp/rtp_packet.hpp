#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

// Packets of RTP and RTCP (RFC 3550).

namespace cartvo::capture {

/// An RTP packet (RFC 3550, 5.1). `payload` views the packet's bytes.
struct RtpPacket {
  std::span<const std::uint8_t> payload;  ///< without padding
  std::uint32_t timestamp = 0;
  std::uint32_t source = 0;  ///< SSRC
  std::uint16_t sequence = 0;
  int payload_type = 0;
  bool marker = false;
};

/// Parses an RTP packet; nothing if it is malformed.
std::optional<RtpPacket> parseRtpPacket(std::span<const std::uint8_t> packet);

/// A sender report: an instant in the sender's two clocks (RFC 3550, 6.4.1).
struct SenderReport {
  std::uint32_t source = 0;      ///< SSRC
  std::int64_t instant_us = 0;   ///< sender's wall clock, µs since the Unix epoch; before 2036
  std::uint32_t timestamp = 0;   ///< RTP time of the same instant
  std::uint32_t ntp_middle = 0;  ///< middle 32 bits of the NTP time stamp, for the receiver's report
};

/// Whether a packet is RTCP rather than RTP, by its type: both may come on one channel or port (RFC 5761, 4).
bool isRtcp(std::span<const std::uint8_t> packet);

/// The used parts of a compound RTCP packet.
struct RtcpContent {
  std::vector<SenderReport> reports;
  std::optional<std::uint32_t> ended_source;  ///< SSRC that left the session (BYE)
  bool is_whole = false;                      ///< no part is malformed
};

/// Parses a compound RTCP packet up to its first malformed part.
RtcpContent parseRtcp(std::span<const std::uint8_t> packet);

/// Statistics of a receiver report (RFC 3550, 6.4.2).
struct ReceiverReport {
  std::uint32_t receiver = 0;  ///< SSRC of the reporter
  std::uint32_t source = 0;    ///< SSRC of the sender
  std::uint32_t lost = 0;      ///< packets, in total
  std::uint32_t highest_sequence = 0;
  std::uint32_t last_report = 0;        ///< ntp_middle of the last sender report, or 0
  std::uint32_t since_last_report = 0;  ///< 1/65536 s, or 0
};

/// A compound packet of a receiver report and the mandatory CNAME (RFC 3550, 6.1).
std::vector<std::uint8_t> receiverReportPacket(const ReceiverReport& report);

}  // namespace cartvo::capture
