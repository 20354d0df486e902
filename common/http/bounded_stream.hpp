#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>

#include <httplib.h>
#include <sys/types.h>

#include "common/threads/wake_event.hpp"

namespace cartvo {

/// Limits of the time and the bytes that a client of an HTTP server may take.
struct HttpLimits {
  std::chrono::milliseconds request_time{2000};  ///< from the connection until the request is complete
  std::chrono::milliseconds answer_time{5000};   ///< after that, until the answer is taken
  std::size_t request_bytes = 16384;             ///< request line and headers
};

/// A connection of a server. Limits it in total time and bytes: httplib's own stream limits the time between
/// two bytes only, so a client that drips bytes keeps a thread, and a line without end fills the memory.
class BoundedStream : public httplib::Stream {
 public:
  /// Owns the connected socket. `stop` ends all waits and must outlive the stream.
  BoundedStream(int socket, const WakeEvent& stop, const HttpLimits& limits);
  ~BoundedStream() override;
  BoundedStream(const BoundedStream&) = delete;
  BoundedStream& operator=(const BoundedStream&) = delete;

  bool is_readable() const override;
  bool is_writable() const override;

  /// Returns -1 if the client has closed the connection or exceeded a limit, or if the server stops.
  ssize_t read(char* data, std::size_t size) override;

  /// Does not wait once the server stops; an answer that fits the socket's buffer is sent nevertheless.
  ssize_t write(const char* data, std::size_t size) override;

  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool wait(short events, Clock::time_point deadline) const;
  bool fill();

  int socket_;
  const WakeEvent& stop_;
  Clock::time_point request_deadline_;
  Clock::time_point answer_deadline_{};  ///< set by the first write
  std::chrono::milliseconds answer_time_;
  std::size_t bytes_left_;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;  ///< of the bytes in the buffer that were not read yet
};

}  // namespace cartvo
