#pragma once

#include <array>
#include <cstdint>
#include <map>
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

/// An RTP packet in its order.
struct SequencedPacket {
  std::vector<std::uint8_t> bytes;  ///< the whole packet
  std::int64_t arrival_ns = 0;      ///< host's clock
  bool data_lost = false;           ///< packets before it are missing
};

/// Brings RTP packets into the order of their sequence numbers, drops duplicates and finds losses (RFC 3550,
/// A.1). A missing packet is waited for while later ones arrive, up to `window` packets and `patience_ns`.
/// With a `window` of 0, for a transport that keeps the order (TCP), packets come out as they arrive,
/// whatever their numbers. Reads no clock; deterministic.
class RtpSequencer {
 public:
  RtpSequencer(std::size_t window, std::int64_t patience_ns) : window_(window), patience_ns_(patience_ns) {}

  /// Adds a packet with its parsed header.
  void add(const RtpPacket& header, SequencedPacket packet);

  /// Removes and returns the next packet in order, or nothing.
  std::optional<SequencedPacket> pop();

  std::uint64_t lost() const { return lost_; }  ///< packets
  std::uint64_t leftOut() const {
    return left_out_;
  }  ///< packets that came too late, twice, or with a stray number
  /// Highest sequence number, extended by the number of wraps (RFC 3550, 6.4.1).
  std::uint32_t highestSequence() const { return static_cast<std::uint32_t>(next_ - 1); }

 private:
  void restart(const RtpPacket& header);
  void addInOrder(const RtpPacket& header, SequencedPacket packet);

  std::size_t window_;
  std::int64_t patience_ns_;
  std::optional<std::uint32_t> source_;
  std::int64_t next_ = 0;  ///< extended number of the packet expected next
  std::map<std::int64_t, SequencedPacket> waiting_;
  std::int64_t newest_arrival_ns_ = 0;
  bool gap_ = false;           ///< packets are missing before the next one
  int out_of_range_ = 0;       ///< packets in a row whose numbers are far from the expected one
  std::int64_t arrivals_ = 0;  ///< packets of a transport that keeps the order
  int skipping_ = 0;  ///< rises with each packet before which numbers are missing, falls with each other
  std::uint64_t lost_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace cartvo::capture
