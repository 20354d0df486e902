// TCP connection to an RTSP server: messages and interleaved packets.

#include "capture/rtsp/rtsp_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <unistd.h>

namespace cartvo::capture {
namespace {

constexpr std::chrono::milliseconds kPollInterval{50};
constexpr std::size_t kBufferSize = 256U << 10;
constexpr std::size_t kInterleavedHeader = 4;
static_assert(kBufferSize > kMaxRtspHead + kMaxRtspBody && kBufferSize > kInterleavedHeader + 0xffff);

RtspInput invalid(std::string reason) {
  RtspInput input;
  input.kind = RtspInput::Kind::invalid;
  input.reason = std::move(reason);
  return input;
}

/// Size of a message's head, including its empty line; nothing if that has not arrived.
std::optional<std::size_t> headSize(std::string_view text) {
  for (const std::string_view end : {"\r\n\r\n", "\n\n"}) {
    const std::size_t found = text.find(end);
    if (found != std::string_view::npos) return found + end.size();
  }
  return std::nullopt;
}

}  // namespace

RtspSocket::~RtspSocket() {
  close();
}

void RtspSocket::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  begin_ = end_ = 0;
}

std::optional<std::string> RtspSocket::connect(const RtspUrl& server, Clock::time_point deadline) {
  close();
  buffer_.resize(kBufferSize);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(server.host.c_str(), server.port.c_str(), &hints, &found); error != 0)
    return gai_strerror(error);
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
  int error = ETIMEDOUT;
  for (const addrinfo* address = found; address != nullptr && !interrupted_; address = address->ai_next) {
    close();
    descriptor_ =
        socket(address->ai_family, address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address->ai_protocol);
    if (descriptor_ < 0) {
      error = errno;
      continue;
    }
    error = ::connect(descriptor_, address->ai_addr, address->ai_addrlen) == 0 ? 0 : errno;
    if (error == EINPROGRESS) {
      error = ETIMEDOUT;
      socklen_t size = sizeof(error);
      if (wait(POLLOUT, deadline, {})) getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size);
    }
    if (error == 0) {
      std::memcpy(&peer_, address->ai_addr, std::min<std::size_t>(address->ai_addrlen, sizeof peer_));
      const int on = 1;
      setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      receiver_.begin(descriptor_);
      return std::nullopt;
    }
  }
  if (interrupted_) return std::nullopt;
  return std::strerror(error);
}

/// Waits until the socket is ready for `events`, or one of `wake` is readable. False at the deadline and
/// after an interruption.
bool RtspSocket::wait(int events, Clock::time_point deadline, std::span<const int> wake) const {
  std::array<pollfd, 4> polled{};
  polled[0] = {descriptor_, static_cast<short>(events), 0};
  const std::size_t count = 1 + std::min(wake.size(), polled.size() - 1);
  for (std::size_t i = 1; i < count; ++i)
    polled[i] = {wake[i - 1], POLLIN, 0};
  while (!interrupted_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    const auto pause = std::clamp(left, std::chrono::milliseconds(0), kPollInterval);
    if (poll(polled.data(), count, static_cast<int>(pause.count())) > 0) return true;
    if (left.count() <= 0) return false;
  }
  return false;
}

bool RtspSocket::send(std::span<const std::uint8_t> data, Clock::time_point deadline) {
  while (!data.empty()) {
    const ssize_t sent = ::send(descriptor_, data.data(), data.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      data = data.subspan(static_cast<std::size_t>(sent));
    } else if (errno != EINTR &&
               ((errno != EAGAIN && errno != EWOULDBLOCK) || !wait(POLLOUT, deadline, {}))) {
      return false;
    }
  }
  return true;
}

RtspInput RtspSocket::receive(Clock::time_point deadline, std::span<const int> wake) {
  for (;;) {
    if (std::optional<RtspInput> input = parseBuffered()) return std::move(*input);
    if (std::optional<RtspInput> failure = fill()) {
      if (failure->kind != RtspInput::Kind::nothing) return std::move(*failure);
      if (!wait(POLLIN, deadline, wake)) return {};
      // Another socket was readable, or this one is: the next read tells.
      failure = fill();
      if (failure) return std::move(*failure);
    }
    if (interrupted_) return {};
  }
}

/// Reads what has arrived. Nothing after a success; Kind::nothing if no data wait.
std::optional<RtspInput> RtspSocket::fill() {
  if (begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  const ssize_t size = receiver_.receive(descriptor_, std::span(buffer_).subspan(end_), nullptr);
  if (size > 0) {
    end_ += static_cast<std::size_t>(size);
    return std::nullopt;
  }
  RtspInput input;
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return input;
  input.kind = RtspInput::Kind::closed;
  input.reason = size == 0 ? "the camera closed the connection" : std::strerror(errno);
  return input;
}

/// Removes and returns the message or packet at the buffer's beginning, if it is complete.
std::optional<RtspInput> RtspSocket::parseBuffered() {
  while (begin_ < end_ && (buffer_[begin_] == '\r' || buffer_[begin_] == '\n'))
    ++begin_;  // empty lines between messages (RFC 2326, 4.1)
  const std::size_t size = end_ - begin_;
  if (size == 0) return std::nullopt;
  const std::uint8_t* data = buffer_.data() + begin_;
  if (data[0] == '$') {
    if (size < kInterleavedHeader) return std::nullopt;
    const std::size_t length = static_cast<std::size_t>(data[2]) << 8 | data[3];
    if (size < kInterleavedHeader + length) return std::nullopt;
    begin_ += kInterleavedHeader + length;
    RtspInput input;
    input.kind = RtspInput::Kind::interleaved;
    input.channel = data[1];
    input.data = {data + kInterleavedHeader, length};
    return input;
  }
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const bool may_be_rtsp = data[0] >= 'A' && data[0] <= 'Z';
  const std::optional<std::size_t> head = headSize(text.substr(0, kMaxRtspHead));
  if (head && may_be_rtsp) {
    RtspInput input = parseMessage(text, *head);
    if (input.kind == RtspInput::Kind::nothing) return std::nullopt;
    return input;
  }
  if (may_be_rtsp && size < kMaxRtspHead) return std::nullopt;
  if (!may_be_rtsp || !text.starts_with("RTSP/")) return notRtsp(text);
  return invalid("sent more than " + std::to_string(kMaxRtspHead) + " bytes of headers");
}

/// For a server that does not speak RTSP: what it has sent.
RtspInput RtspSocket::notRtsp(std::string_view text) const {
  const std::string line = quotes_ ? quotedForMessage(text.substr(0, text.find('\n'))) : "...";
  if (text.starts_with("HTTP/"))
    return invalid("answered by HTTP (" + line +
                   "): this is a web server's port; cameras speak RTSP on port 554");
  return invalid("sent what is not RTSP: '" + line + "'");
}

/// Parses a message whose head is complete; Kind::nothing while its body is not.
RtspInput RtspSocket::parseMessage(std::string_view text, std::size_t head_size) {
  std::optional<RtspHead> head = parseRtspHead(text.substr(0, head_size));
  if (!head) return notRtsp(text);
  const std::size_t body_size = head->number("content-length").value_or(0);
  if (body_size > kMaxRtspBody) {
    return invalid("announces an answer of " + std::to_string(body_size) + " bytes; at most " +
                   std::to_string(kMaxRtspBody) + " are accepted");
  }
  if (text.size() < head_size + body_size) return {};
  begin_ += head_size + body_size;
  RtspInput input;
  input.kind = RtspInput::Kind::message;
  input.head = std::move(*head);
  if (!quotes_) input.head.reason.clear();
  input.body = text.substr(head_size, body_size);
  return input;
}

}  // namespace cartvo::capture
