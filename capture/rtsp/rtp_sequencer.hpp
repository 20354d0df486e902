#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "capture/rtsp/rtp_packet.hpp"

namespace cartvo::capture {

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
