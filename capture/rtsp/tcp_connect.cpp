// Test of a TCP connection with a short time-out.

#include "capture/rtsp/tcp_connect.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo::capture {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPollInterval{50};
constexpr const char* kRtspPort = "554";  // RFC 2326, 3.2

/// Splits into host and port: "HOST", "HOST:PORT" or "[IPV6]:PORT".
std::pair<std::string, std::string> splitHostPort(const std::string& host) {
  const std::size_t bracket = host.find(']');
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  const std::string port = colon == std::string::npos ? kRtspPort : host.substr(colon + 1);
  if (bracket != std::string::npos) return {host.substr(1, bracket - 1), port};
  return {host.substr(0, colon), port};
}

/// Owner of a non-blocking socket.
class Socket {
 public:
  explicit Socket(const addrinfo& address)
      : descriptor_(socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC,
                           address.ai_protocol)) {}
  ~Socket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Connects. Returns 0 on success or interruption, else an errno.
int connectUntil(const Socket& socket, const addrinfo& address, Clock::time_point deadline,
                 const std::atomic<bool>& interrupted) {
  if (connect(socket.get(), address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  while (!interrupted && Clock::now() < deadline) {
    pollfd polled{socket.get(), POLLOUT, 0};
    if (poll(&polled, 1, static_cast<int>(kPollInterval.count())) <= 0) continue;
    int error = 0;
    socklen_t size = sizeof(error);
    getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    return error;
  }
  return interrupted ? 0 : ETIMEDOUT;
}

}  // namespace

std::optional<std::string> tcpConnectError(const std::string& host, std::chrono::milliseconds timeout,
                                           const std::atomic<bool>& interrupted) {
  const auto [name, port] = splitHostPort(host);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(name.c_str(), port.c_str(), &hints, &found); error != 0)
    return gai_strerror(error);
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
  const Clock::time_point deadline = Clock::now() + timeout;
  int error = ETIMEDOUT;
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    const Socket socket(*address);
    error = socket.get() < 0 ? errno : connectUntil(socket, *address, deadline, interrupted);
    if (error == 0) return std::nullopt;
  }
  return std::strerror(error);
}

}  // namespace cartvo::capture
