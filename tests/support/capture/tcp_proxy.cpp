// TCP proxy that can stall a connection.

#include "tests/support/capture/tcp_proxy.hpp"

#include <array>
#include <stdexcept>
#include <vector>

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo::test {
namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void closeBoth(std::array<int, 2>& sockets) {
  for (int& socket : sockets) {
    if (socket >= 0) close(socket);
    socket = -1;
  }
}

/// Forwards the available data. False once either side has closed.
bool forward(int from, int to) {
  std::array<char, 65536> buffer{};
  const ssize_t size = recv(from, buffer.data(), buffer.size(), 0);
  if (size <= 0) return false;
  for (ssize_t sent = 0; sent < size;) {
    const ssize_t step = send(to, buffer.data() + sent, static_cast<std::size_t>(size - sent), MSG_NOSIGNAL);
    if (step <= 0) return false;
    sent += step;
  }
  return true;
}

}  // namespace

TcpProxy::TcpProxy(std::uint16_t target_port) : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof(address);
  if (listener_ < 0 || bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      listen(listener_, 4) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("cannot listen on loopback");
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this, target_port] { run(target_port); });
}

TcpProxy::~TcpProxy() {
  stopping_ = true;
  thread_.join();
  close(listener_);
}

void TcpProxy::run(std::uint16_t target_port) {
  std::array<int, 2> sockets = {-1, -1};  // client, camera
  std::vector<int> stalled;               // kept open, so that the client receives neither data nor an end
  while (!stopping_) {
    if (stalled_.exchange(false)) {
      stalled.insert(stalled.end(), sockets.begin(), sockets.end());
      sockets = {-1, -1};
    }
    std::array<pollfd, 3> polled{{{listener_, POLLIN, 0}, {sockets[0], POLLIN, 0}, {sockets[1], POLLIN, 0}}};
    if (poll(polled.data(), polled.size(), 10) <= 0) continue;
    if ((polled[0].revents & POLLIN) != 0) {
      closeBoth(sockets);
      sockets[0] = accept(listener_, nullptr, nullptr);
      sockets[1] = socket(AF_INET, SOCK_STREAM, 0);
      const sockaddr_in camera = loopback(target_port);
      if (connect(sockets[1], reinterpret_cast<const sockaddr*>(&camera), sizeof(camera)) != 0)
        closeBoth(sockets);
      continue;
    }
    if (stalled_) continue;
    for (std::size_t i = 0; i < sockets.size(); ++i) {
      if (sockets[i] < 0 || polled[i + 1].revents == 0) continue;
      if (!forward(sockets[i], sockets[1 - i])) closeBoth(sockets);
    }
  }
  closeBoth(sockets);
  for (const int socket : stalled)
    close(socket);
}

}  // namespace cartvo::test
