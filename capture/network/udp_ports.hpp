#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <sys/socket.h>

namespace cartvo::capture {

/// Reads a socket and tells when the kernel received the data: on a busy computer, this process reads them
/// tens of milliseconds later.
class TimedReceiver {
 public:
  /// To be called once for a new socket, which does not block.
  void begin(int descriptor);

  /// As recvfrom(2). `from` may be null.
  ssize_t receive(int descriptor, std::span<std::uint8_t> into, sockaddr_storage* from);

  /// Reception of what was read last, or of its last part, by the host's clock (hostNow()).
  std::int64_t arrivalNs() const { return arrival_ns_; }

 private:
  std::int64_t empty_ns_ = 0;  ///< nothing waited to be read then, so that what is read arrived later
  std::int64_t arrival_ns_ = 0;
};

/// A pair of UDP sockets on adjacent ports, an even one for RTP and the next one for RTCP (RFC 3550, 11).
class UdpPorts {
 public:
  /// Opens a free pair. Throws std::system_error if there is none.
  explicit UdpPorts(sa_family_t family);
  ~UdpPorts();
  UdpPorts(const UdpPorts&) = delete;
  UdpPorts& operator=(const UdpPorts&) = delete;

  std::uint16_t rtpPort() const { return port_; }
  const std::array<int, 2>& descriptors() const { return descriptors_; }  ///< RTP, RTCP

  /// Accepts packets from this host, or from these ports of another one (a server with several addresses may
  /// send from another than it was asked at), and sends to its ports `rtp` and `rtp + 1`. An empty packet to
  /// each opens the way through firewalls on it. `rtp` is 0 while the ports are unknown.
  void setPeer(const sockaddr_storage& host, std::uint16_t rtp);

  /// Receives a packet that has arrived, of RTP (`which` = 0) or RTCP (1). The view is valid until the next
  /// call. Nothing if none has.
  std::optional<std::span<const std::uint8_t>> receive(std::size_t which);

  /// Arrival of the RTP packet received last, by the host's clock.
  std::int64_t arrivalNs() const { return receivers_[0].arrivalNs(); }

  /// Number of packets from other computers, which were left out, and the address of the last one.
  std::uint64_t foreign() const { return foreign_; }
  std::string foreignAddress() const;

  void sendRtcp(std::span<const std::uint8_t> packet) { send(1, packet); }

 private:
  bool open(sa_family_t family, std::uint16_t port);
  void closeAll();
  void send(std::size_t which, std::span<const std::uint8_t> packet);

  std::array<int, 2> descriptors_{-1, -1};
  std::array<TimedReceiver, 2> receivers_;
  std::uint16_t port_ = 0;
  std::optional<sockaddr_storage> peer_;
  std::uint16_t peer_port_ = 0;
  std::uint64_t foreign_ = 0;
  sockaddr_storage foreign_address_{};
  std::array<std::uint8_t, 65536> buffer_{};
};

}  // namespace cartvo::capture
