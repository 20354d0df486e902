// Reading of a socket with the kernel's time stamps.

#include "capture/network/timed_receiver.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>

#include <sys/uio.h>

#include "common/host_clock.hpp"

namespace cartvo::capture {
namespace {

/// Time since the kernel received the message, ns; 0 if it does not tell. Wrong if the wall clock, which it
/// tells, has been set meanwhile.
std::int64_t age(msghdr& message) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
    const auto received = std::chrono::seconds(stamp.tv_sec) + std::chrono::nanoseconds(stamp.tv_nsec);
    const auto since = std::chrono::system_clock::now().time_since_epoch() - received;
    return std::chrono::duration_cast<std::chrono::nanoseconds>(since).count();
  }
  return 0;
}

}  // namespace

void TimedReceiver::begin(int descriptor) {
  const int on = 1;
  setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  empty_ns_ = hostNow();
}

ssize_t TimedReceiver::receive(int descriptor, std::span<std::uint8_t> into, sockaddr_storage* from) {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
  iovec data{into.data(), into.size()};
  msghdr message{};
  message.msg_name = from;
  message.msg_namelen = from == nullptr ? 0 : sizeof *from;
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(descriptor, &message, 0);
  const std::int64_t now_ns = hostNow();
  if (size >= 0) {
    arrival_ns_ = std::clamp(now_ns - age(message), std::min(empty_ns_, now_ns), now_ns);
  } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
    empty_ns_ = now_ns;
  }
  return size;
}

}  // namespace cartvo::capture
