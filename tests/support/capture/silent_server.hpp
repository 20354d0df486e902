#pragma once

#include <cstdint>
#include <stdexcept>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo::test {

/// A server on loopback that never answers; the kernel accepts up to `queue` + 1 connections for it.
class SilentServer {
 public:
  explicit SilentServer(int queue) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    auto* const generic = reinterpret_cast<sockaddr*>(&address_);
    if (::bind(socket_, generic, size) == 0 && ::listen(socket_, queue) == 0 &&
        ::getsockname(socket_, generic, &size) == 0)
      return;
    ::close(socket_);
    throw std::runtime_error("cannot listen on loopback");
  }
  ~SilentServer() { ::close(socket_); }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;

  const sockaddr_in& address() const { return address_; }
  std::uint16_t port() const { return ntohs(address_.sin_port); }

 private:
  int socket_;
  sockaddr_in address_{};
};

}  // namespace cartvo::test
