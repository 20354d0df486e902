// Connection of an HTTP server, limited in time and size.
#include "common/http/bounded_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo {
namespace {

bool wouldBlock() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

BoundedStream::BoundedStream(int socket, const WakeEvent& stop, const HttpLimits& limits)
    : socket_(socket),
      stop_(stop),
      request_deadline_(Clock::now() + limits.request_time),
      answer_time_(limits.answer_time),
      bytes_left_(limits.request_bytes) {}

BoundedStream::~BoundedStream() {
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
}

bool BoundedStream::is_readable() const {
  return begin_ < end_ || wait(POLLIN, request_deadline_);
}

bool BoundedStream::is_writable() const {
  return wait(POLLOUT, Clock::now() + answer_time_);
}

/// Waits until the socket is ready; false at the deadline and when the server stops.
bool BoundedStream::wait(short events, Clock::time_point deadline) const {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    std::array<pollfd, 2> waiting{{{socket_, events, 0}, {stop_.descriptor(), POLLIN, 0}}};
    const int ready =
        poll(waiting.data(), waiting.size(), static_cast<int>(std::min<std::int64_t>(left, 60'000)));
    if (ready < 0 && errno != EINTR) return false;
    if (ready > 0) return waiting[1].revents == 0;
  }
}

bool BoundedStream::fill() {
  while (bytes_left_ > 0 && wait(POLLIN, request_deadline_)) {
    const ssize_t received =
        recv(socket_, buffer_.data(), std::min(buffer_.size(), bytes_left_), MSG_DONTWAIT);
    if (received < 0 && wouldBlock()) continue;
    if (received <= 0) return false;
    begin_ = 0;
    end_ = static_cast<std::size_t>(received);
    bytes_left_ -= end_;
    return true;
  }
  return false;
}

ssize_t BoundedStream::read(char* data, std::size_t size) {
  if (begin_ == end_ && !fill()) return -1;
  const std::size_t count = std::min(size, end_ - begin_);
  std::memcpy(data, buffer_.data() + begin_, count);
  begin_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t BoundedStream::write(const char* data, std::size_t size) {
  if (answer_deadline_ == Clock::time_point{}) answer_deadline_ = Clock::now() + answer_time_;
  while (true) {
    const ssize_t sent = send(socket_, data, size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent >= 0) return sent;
    if (!wouldBlock() || !wait(POLLOUT, answer_deadline_)) return -1;
  }
}

}  // namespace cartvo
