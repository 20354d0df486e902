#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace cartvo::test {

/// TCP proxy between a camera and its client on loopback, for one connection at a time. Simulates an
/// unplugged cable: it can stop forwarding without closing the connection.
class TcpProxy {
 public:
  /// Throws std::runtime_error if it cannot listen.
  explicit TcpProxy(std::uint16_t target_port);
  ~TcpProxy();
  TcpProxy(const TcpProxy&) = delete;
  TcpProxy& operator=(const TcpProxy&) = delete;

  std::uint16_t port() const { return port_; }

  /// Stalls the current connection; a new connection is forwarded again.
  void stall() { stalled_ = true; }

 private:
  void run(std::uint16_t target_port);

  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> stalled_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace cartvo::test
