#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace cartvo::test {

/// Stands between a camera and its client on loopback, one connection at a time, so that a test can stop the
/// flow without either side being told: a pulled cable.
class TcpProxy {
 public:
  /// Throws std::runtime_error if it cannot listen.
  explicit TcpProxy(std::uint16_t target_port);
  ~TcpProxy();
  TcpProxy(const TcpProxy&) = delete;
  TcpProxy& operator=(const TcpProxy&) = delete;

  std::uint16_t port() const { return port_; }

  /// From now on nothing passes on the connection there is; a new connection passes again.
  void freeze() { frozen_ = true; }

 private:
  void run(std::uint16_t target_port);

  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> frozen_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace cartvo::test
