#pragma once

#include <cstdint>
#include <span>

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

}  // namespace cartvo::capture
