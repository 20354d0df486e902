// TCP connection to an RTSP server: messages and interleaved packets.

#include "capture/rtsp/rtsp_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <unistd.h>

#include "common/ascii_text.hpp"

namespace cartvo::capture {
namespace {

constexpr std::chrono::milliseconds kPollInterval{50};
constexpr std::size_t kBufferSize = 256U << 10;
constexpr std::size_t kInterleavedHeader = 4;
constexpr std::size_t kMaxSkipped = kBufferSize;  ///< bytes in a row that are no packet and no message
constexpr std::size_t kMaxMethod = 13;            ///< letters of a request's method: SET_PARAMETER
constexpr std::size_t kMaxRequestLine = 1024;
// After a pause of this length nothing more of a description comes whose length is missing or too small; one
// whose length says that more is to come may wait for a packet that was lost on the way.
constexpr std::chrono::milliseconds kRestPause{300}, kLostRestPause{1000};
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

/// Whether a message carries a session description (SDP), also one that does not say so.
bool isDescription(const RtspHead& head, std::string_view body) {
  if (head.status != 200) return false;
  return lowerCase(head.header("content-type").value_or("")).find("sdp") != std::string::npos ||
         body.starts_with("v=") || body.starts_with("m=");
}

/// Whether the stated length is that of the description: it ends with a line, and the next thing follows.
bool isWholeDescription(std::string_view received, std::optional<std::size_t> stated) {
  if (!stated || *stated == 0 || *stated > received.size() || received[*stated - 1] != '\n') return false;
  const std::string_view after = received.substr(*stated);
  return after.empty() || after.starts_with("$") || after.starts_with("RTSP/");
}

}  // namespace

RtspSocket::~RtspSocket() {
  close();
}

void RtspSocket::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  begin_ = end_ = skipped_since_ = 0;
  speaks_rtsp_ = false;
  rest_pause_.reset();
  channels_.reset();
}

std::optional<std::string> RtspSocket::connect(const RtspUrl& server, Clock::time_point deadline) {
  close();
  buffer_.resize(kBufferSize);
  const ResolvedName name = resolveName(server.host, server.port, deadline, interrupted_);
  std::string errors = name.error;
  const std::size_t count = name.addresses.size();
  for (std::size_t i = 0; i < count && !interrupted_; ++i) {
    const ServerAddress& address = name.addresses[i];
    // Each address gets its share of the time: one that does not answer must not use up that of the others.
    const Clock::time_point now = Clock::now();
    const int error = connectTo(address, now + (deadline - now) / static_cast<int>(count - i));
    if (error == 0) return std::nullopt;
    const std::string text = address.text();
    if (!errors.empty()) errors += "; ";
    if (count > 1 || text != server.host) errors.append(text).append(": ");
    errors += std::strerror(error);
  }
  if (interrupted_) return std::nullopt;
  return errors;
}

/// Connects to one address. Returns the error number, 0 on success.
int RtspSocket::connectTo(const ServerAddress& address, Clock::time_point deadline) {
  close();
  descriptor_ = socket(address.address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) return errno;
  int error = ::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address.address), address.size) == 0
                  ? 0
                  : errno;
  if (error == EINPROGRESS) {
    error = ETIMEDOUT;
    socklen_t size = sizeof(error);
    if (wait(POLLOUT, deadline, {})) getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size);
  }
  if (error != 0) return error;
  peer_ = address.address;
  const int on = 1;
  setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  receiver_.begin(descriptor_);
  return 0;
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
    if (std::optional<RtspInput> input = parseBuffered(false)) return std::move(*input);
    std::optional<RtspInput> failure = fill();
    if (failure && failure->kind == RtspInput::Kind::nothing) {
      const Clock::time_point until = rest_pause_ ? std::min(deadline, arrival_ + *rest_pause_) : deadline;
      // Another socket was readable, or this one is: the next read tells.
      if (wait(POLLIN, until, wake)) failure = fill();
    }
    if (failure) {
      const bool is_over = failure->kind != RtspInput::Kind::nothing || !rest_pause_ ||
                           Clock::now() >= arrival_ + *rest_pause_;
      if (rest_pause_ && is_over) {
        if (std::optional<RtspInput> input = parseBuffered(true)) return std::move(*input);
      }
      if (is_over || Clock::now() >= deadline) return std::move(*failure);
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
    arrival_ = Clock::now();
    return std::nullopt;
  }
  RtspInput input;
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return input;
  input.kind = RtspInput::Kind::closed;
  input.reason = size == 0 ? "the camera closed the connection" : std::strerror(errno);
  return input;
}

/// The kind of input that begins with these bytes.
RtspSocket::Beginning RtspSocket::beginningOf(std::string_view text) const {
  if (text[0] == '$') return beginningOfPacket(text);
  constexpr std::string_view kResponse = "RTSP/";
  const std::string_view prefix = text.substr(0, kResponse.size());
  if (kResponse.starts_with(prefix))
    return prefix.size() == kResponse.size() ? Beginning::message : Beginning::unknown;
  // A request: a method in capitals, and the version at the end of its line.
  const std::string_view begin = text.substr(0, kMaxRequestLine);
  const std::string_view line = begin.substr(0, begin.find('\n'));
  const std::size_t method = std::min(line.find(' '), line.size());
  const auto is_of_method = [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; };
  if (method > kMaxMethod ||
      !std::all_of(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(method), is_of_method))
    return Beginning::nothing;
  if (line.size() < text.size())
    return line.find(" RTSP/") != std::string_view::npos ? Beginning::message : Beginning::nothing;
  return Beginning::unknown;
}

/// As beginningOf, of a '$'. A packet that is not RTP or RTCP by its version, and one after bytes that are no
/// packet, must be followed by a packet or message: a '$' may stand among such bytes.
RtspSocket::Beginning RtspSocket::beginningOfPacket(std::string_view text) const {
  if (text.size() < kInterleavedHeader) return Beginning::unknown;
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(text[at]); };
  const std::size_t size = kInterleavedHeader + (static_cast<std::size_t>(byte(2)) << 8 | byte(3));
  if (size > kInterleavedHeader && text.size() == kInterleavedHeader) return Beginning::unknown;
  constexpr int kRtpVersion = 2;
  const bool is_rtp = size > kInterleavedHeader && byte(kInterleavedHeader) >> 6 == kRtpVersion;
  if (skipped_since_ == 0 && is_rtp) return text.size() < size ? Beginning::unknown : Beginning::packet;
  if (skipped_since_ > 0 && !(is_rtp && channels_[byte(1)])) return Beginning::nothing;
  if (text.size() < size) return Beginning::unknown;
  constexpr std::string_view kNext =
      "$RAOGSPT\r\n";  // packets, responses, the server's requests, empty lines
  const bool is_followed = text.size() == size || kNext.find(text[size]) != std::string_view::npos;
  return is_followed ? Beginning::packet : Beginning::nothing;
}

/// Removes and returns the message or packet at the buffer's beginning, if it is complete. Leaves out bytes
/// that belong to neither: cameras whose connection was congested write parts of packets twice. `at_rest`:
/// nothing more is expected at present.
std::optional<RtspInput> RtspSocket::parseBuffered(bool at_rest) {
  rest_pause_.reset();
  for (;;) {
    while (begin_ < end_ && (buffer_[begin_] == '\r' || buffer_[begin_] == '\n'))
      ++begin_;  // empty lines between messages (RFC 2326, 4.1)
    if (begin_ == end_) return std::nullopt;
    const std::string_view text(reinterpret_cast<const char*>(buffer_.data() + begin_), end_ - begin_);
    if (!speaks_rtsp_ && text[0] != '$') return parseFirst(text, at_rest);
    const Beginning beginning = beginningOf(text);
    if (beginning == Beginning::unknown) return std::nullopt;
    if (beginning == Beginning::packet) return takePacket();
    if (beginning == Beginning::message) {
      const std::optional<std::size_t> head = headSize(text.substr(0, kMaxRtspHead));
      if (head) return parseMessage(text, *head, at_rest);
      if (text.size() < kMaxRtspHead) return std::nullopt;
    }
    if (skipped_since_ == 0) ++skips_;
    ++begin_;
    if (++skipped_since_ > kMaxSkipped) {
      return invalid("sent " + std::to_string(kMaxSkipped) +
                     " bytes in a row that are neither RTSP messages nor interleaved packets");
    }
  }
}

/// Parses the server's first message, which tells whether it speaks RTSP.
std::optional<RtspInput> RtspSocket::parseFirst(std::string_view text, bool at_rest) {
  const bool may_be_rtsp = text[0] >= 'A' && text[0] <= 'Z';
  const std::optional<std::size_t> head = headSize(text.substr(0, kMaxRtspHead));
  if (head && may_be_rtsp) return parseMessage(text, *head, at_rest);
  if (may_be_rtsp && text.size() < kMaxRtspHead) return std::nullopt;
  if (!may_be_rtsp || !text.starts_with("RTSP/")) return notRtsp(text);
  return invalid("sent more than " + std::to_string(kMaxRtspHead) + " bytes of headers");
}

/// Removes and returns the complete packet at the buffer's beginning.
RtspInput RtspSocket::takePacket() {
  const std::uint8_t* data = buffer_.data() + begin_;
  const std::size_t length = static_cast<std::size_t>(data[2]) << 8 | data[3];
  begin_ += kInterleavedHeader + length;
  skipped_since_ = 0;
  channels_.set(data[1]);
  RtspInput input;
  input.kind = RtspInput::Kind::interleaved;
  input.channel = data[1];
  input.data = {data + kInterleavedHeader, length};
  return input;
}

/// For a server that does not speak RTSP: what it has sent.
RtspInput RtspSocket::notRtsp(std::string_view text) const {
  const std::string line = quotes_ ? quotedForMessage(text.substr(0, text.find('\n'))) : "...";
  if (text.starts_with("HTTP/"))
    return invalid("answered by HTTP (" + line +
                   "): this is a web server's port; cameras speak RTSP on port 554");
  if (text.starts_with("\x15\x03") || text.starts_with("\x16\x03"))
    return invalid("answered by TLS: this is the port of encrypted streams (RTSPS), set that of RTSP, 554");
  return invalid("sent what is not RTSP: '" + line + "'");
}

/// Parses a message whose head is complete; nothing while its body is not.
std::optional<RtspInput> RtspSocket::parseMessage(std::string_view text, std::size_t head_size,
                                                  bool at_rest) {
  std::optional<RtspHead> head = parseRtspHead(text.substr(0, head_size));
  if (!head) return notRtsp(text);
  const std::optional<std::size_t> stated = head->number("content-length");
  if (stated.value_or(0) > kMaxRtspBody) {
    return invalid("announces an answer of " + std::to_string(*stated) + " bytes; at most " +
                   std::to_string(kMaxRtspBody) + " are accepted");
  }
  const std::string_view rest = text.substr(head_size);
  std::size_t body_size = stated.value_or(0);
  if (isDescription(*head, rest) && !isWholeDescription(rest, stated)) {
    // Its length is missing or wrong: it ends where a message begins, or where nothing more comes.
    if (!at_rest) {
      rest_pause_ = stated.value_or(0) > rest.size() ? kLostRestPause : kRestPause;
      return std::nullopt;
    }
    body_size = std::min({rest.size(), rest.find("RTSP/1."), kMaxRtspBody});
  }
  if (rest.size() < body_size) return std::nullopt;
  begin_ += head_size + body_size;
  skipped_since_ = 0;
  speaks_rtsp_ = true;
  RtspInput input;
  input.kind = RtspInput::Kind::message;
  input.head = std::move(*head);
  if (!quotes_ && input.head.status != 0) input.head.reason.clear();  // of a request it is the method
  input.body = rest.substr(0, body_size);
  return input;
}

}  // namespace cartvo::capture
