#pragma once

#include <atomic>
#include <bitset>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <sys/socket.h>

#include "capture/network/name_resolver.hpp"
#include "capture/network/udp_ports.hpp"
#include "capture/rtsp/rtsp_message.hpp"
#include "capture/rtsp/rtsp_url.hpp"

namespace cartvo::capture {

/// One thing received over an RTSP connection.
struct RtspInput {
  enum class Kind : std::uint8_t {
    nothing,      ///< timed out or interrupted
    message,      ///< `head` and `body`: a response, or a request of the server
    interleaved,  ///< `data`: a binary packet (RFC 2326, 10.12)
    closed,       ///< the camera closed the connection, or it failed; `reason` says how
    invalid,      ///< no RTSP, or more than is accepted; `reason` says what
  };
  Kind kind = Kind::nothing;
  RtspHead head;
  std::string body;
  int channel = 0;
  std::span<const std::uint8_t> data;  ///< valid until the next call of the socket
  std::string reason;
};

/// TCP connection to an RTSP server. As players do, it goes on after bytes that belong to no packet, and
/// reads a session description whose Content-Length is missing or wrong. Calls return at their deadline, and
/// within 0.1 s after an interruption.
class RtspSocket {
 public:
  using Clock = std::chrono::steady_clock;

  /// `interrupted` must outlive the socket.
  explicit RtspSocket(const std::atomic<bool>& interrupted) : interrupted_(interrupted) {}
  ~RtspSocket();
  RtspSocket(const RtspSocket&) = delete;
  RtspSocket& operator=(const RtspSocket&) = delete;

  /// Connects, or connects anew. Returns the error's text, or nothing on success or interruption.
  std::optional<std::string> connect(const RtspUrl& server, Clock::time_point deadline);

  /// Sends everything. False if the connection failed or the deadline passed.
  bool send(std::span<const std::uint8_t> data, Clock::time_point deadline);

  /// Waits for the next message or packet. `wake`: further sockets to wait for; the result is `nothing` as
  /// soon as one of them is readable.
  RtspInput receive(Clock::time_point deadline, std::span<const int> wake = {});

  /// From now on no text of the server gets into reasons: it has received a readable password, which its
  /// answers may repeat.
  void stopQuoting() { quotes_ = false; }
  bool quotes() const { return quotes_; }

  /// Arrival of the last part of what was received last, by the host's clock.
  std::int64_t arrivalNs() const { return receiver_.arrivalNs(); }

  /// Times that bytes were left out because they belong to no message and no packet.
  std::uint64_t skips() const { return skips_; }

  /// Address of the server, if connected.
  const sockaddr_storage& peer() const { return peer_; }

 private:
  int connectTo(const ServerAddress& address, Clock::time_point deadline);
  enum class Beginning : std::uint8_t { nothing, unknown, message, packet };
  Beginning beginningOf(std::string_view text) const;
  Beginning beginningOfPacket(std::string_view text) const;
  std::optional<RtspInput> parseBuffered(bool at_rest);
  std::optional<RtspInput> parseFirst(std::string_view text, bool at_rest);
  std::optional<RtspInput> parseMessage(std::string_view text, std::size_t head_size, bool at_rest);
  RtspInput takePacket();
  RtspInput notRtsp(std::string_view text) const;
  std::optional<RtspInput> fill();
  bool wait(int events, Clock::time_point deadline, std::span<const int> wake) const;
  void close();

  const std::atomic<bool>& interrupted_;
  bool quotes_ = true;
  int descriptor_ = -1;
  sockaddr_storage peer_{};
  TimedReceiver receiver_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  ///< of the data in the buffer that are not yet parsed
  std::size_t end_ = 0;
  std::bitset<256> channels_;  ///< on which packets have come
  bool speaks_rtsp_ = false;   ///< a message has come
  /// How long to wait for the rest of a description whose length is missing or wrong; empty: for none.
  std::optional<std::chrono::milliseconds> rest_pause_;
  Clock::time_point arrival_{};    ///< of the last data
  std::size_t skipped_since_ = 0;  ///< bytes left out since the last packet or message
  std::uint64_t skips_ = 0;        ///< times that bytes were left out
};

}  // namespace cartvo::capture
