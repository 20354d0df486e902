#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <httplib.h>
#include <sys/types.h>

#include "common/http/listen_address.hpp"
#include "common/threads/wake_event.hpp"

// Code that small HTTP servers share. Library cartvo_http. Include it after Eigen: <resolv.h>, which httplib
// includes, defines the macro _res.

namespace cartvo {

/// Limits of the time and the bytes that a client of an HTTP server may take.
struct HttpLimits {
  std::chrono::milliseconds request_time{2000};  ///< from the connection until the request is complete
  std::chrono::milliseconds answer_time{5000};   ///< after that, until the answer is taken
  /// For the request, and until more of the answer is taken, while other clients wait for a thread.
  std::chrono::milliseconds crowded_time{100};
  std::size_t request_bytes = 16384;  ///< request line and headers
};

/// A connection of a server. Limits it in total time and bytes: httplib's own stream limits the time between
/// two bytes only, so a client that drips bytes keeps a thread, and a line without end fills the memory.
class BoundedStream : public httplib::Stream {
 public:
  /// Owns the connected socket. `stop` ends all waits; `queued` is the number of clients that wait for a
  /// thread. Both must outlive the stream.
  BoundedStream(int socket, const WakeEvent& stop, const std::atomic<std::size_t>& queued,
                const HttpLimits& limits);
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

  bool wait(short events, Clock::time_point begin, Clock::time_point deadline) const;
  bool fill();

  int socket_;
  const WakeEvent& stop_;
  const std::atomic<std::size_t>& queued_;
  HttpLimits limits_;
  Clock::time_point begin_time_ = Clock::now();
  Clock::time_point answer_deadline_{};  ///< set by the first write
  std::size_t bytes_left_;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;  ///< of the bytes in the buffer that were not read yet
};

constexpr const char* kPlainText = "text/plain; charset=utf-8";  ///< media type of an answer

/// Thread pool of a server with a bounded queue: further connections wait until there is room.
class BoundedTaskQueue : public httplib::TaskQueue {
 public:
  /// `queued`: set to the number of jobs that no thread has begun. Throws std::system_error if a thread
  /// cannot be made.
  BoundedTaskQueue(std::size_t threads, std::size_t max_queued_jobs, std::atomic<std::size_t>& queued);
  ~BoundedTaskQueue() override;
  BoundedTaskQueue(const BoundedTaskQueue&) = delete;
  BoundedTaskQueue& operator=(const BoundedTaskQueue&) = delete;

  void enqueue(std::function<void()> job) override;
  void shutdown() override;

 private:
  void work();

  std::size_t max_queued_jobs_;
  std::atomic<std::size_t>& queued_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  std::vector<std::thread> threads_;
  bool is_over_ = false;
};

/// HTTP server with threads of its own. It answers only GET and HEAD requests, and POST requests to paths
/// defined for them, whose Host header is absent, a numeric address or localhost, so that no other site can
/// make a browser read it ("DNS rebinding"); it says so to others. It does not share its port with other
/// programs. Each connection is for one request, limited by HttpLimits; at most `threads` clients are served
/// at a time, and as many again wait: meanwhile those that are served have less time. A connection without a
/// request waits in the operating system.
class HttpService : private httplib::Server {
 public:
  explicit HttpService(std::size_t threads, const HttpLimits& limits = {});

  /// Stops: disconnects all clients and ends the threads.
  ~HttpService() override;
  HttpService(const HttpService&) = delete;
  HttpService& operator=(const HttpService&) = delete;

  using httplib::Server::Get;
  using httplib::Server::set_default_headers;

  /// Defines the answer to POST requests to `path`.
  void Post(const std::string& path, Handler handler);

  /// Size of each connection's buffer of bytes to send. An answer that fits it keeps no thread waiting for
  /// the client. Call it before `bind`; by default the operating system chooses.
  void setSendBuffer(int bytes) { send_buffer_ = bytes; }

  /// Answers whatever the Host header is, for a server whose data need a token. Call it before `start`.
  void allowAnyHost() { allows_any_host_ = true; }

  /// Binds the address and returns the port; -1 if that fails, for example because the port is taken.
  int bind(const ListenAddress& address);

  /// Begins to answer at the bound address. Call it once, after the paths are defined: what they use must
  /// outlive the server. The threads inherit the calling thread's priority. Throws std::system_error if a
  /// thread cannot be made.
  void start();

 private:
  bool process_and_close_socket(socket_t socket) override;
  bool refuse(const httplib::Request& request, httplib::Response& response) const;

  std::set<std::string> post_paths_;
  std::size_t threads_;
  HttpLimits limits_;
  bool allows_any_host_ = false;
  int send_buffer_ = 0;  ///< bytes; 0: not set
  WakeEvent stop_;
  std::atomic<std::size_t> queued_ = 0;      ///< connections
  std::unique_ptr<BoundedTaskQueue> queue_;  ///< until the listener takes it
  std::atomic<bool> has_ended_ = false;      ///< the listener
  std::thread listener_;
};

}  // namespace cartvo
