// UDP sockets for RTP and RTCP, and when the kernel received what they read.
#include "capture/network/udp_ports.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <random>
#include <system_error>

#include <netinet/in.h>
#include <sys/uio.h>
#include <unistd.h>

#include "capture/network/name_resolver.hpp"
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

constexpr int kAttempts = 64;
constexpr int kMaxForeign = 64;          ///< packets of other computers in a row
constexpr int kReceiveBuffer = 2 << 20;  ///< bytes; the kernel may grant less
constexpr std::uint16_t kFirstPort = 20000;
constexpr std::uint16_t kLastPort = 60000;

void setPort(sockaddr_storage& address, std::uint16_t port) {
  if (address.ss_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6&>(address).sin6_port = htons(port);
  } else {
    reinterpret_cast<sockaddr_in&>(address).sin_port = htons(port);
  }
}

std::uint16_t portOf(const sockaddr_storage& address) {
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

socklen_t sizeOf(const sockaddr_storage& address) {
  return address.ss_family == AF_INET6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
}

bool hasSameHost(const sockaddr_storage& a, const sockaddr_storage& b) {
  if (a.ss_family != b.ss_family) return false;
  if (a.ss_family == AF_INET6) {
    return std::memcmp(&reinterpret_cast<const sockaddr_in6&>(a).sin6_addr,
                       &reinterpret_cast<const sockaddr_in6&>(b).sin6_addr, sizeof(in6_addr)) == 0;
  }
  return reinterpret_cast<const sockaddr_in&>(a).sin_addr.s_addr ==
         reinterpret_cast<const sockaddr_in&>(b).sin_addr.s_addr;
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

UdpPorts::UdpPorts(sa_family_t family) {
  std::minstd_rand random(std::random_device{}());
  std::uniform_int_distribution<int> pairs(kFirstPort / 2, kLastPort / 2);
  for (int i = 0; i < kAttempts; ++i) {
    port_ = static_cast<std::uint16_t>(2 * pairs(random));
    if (open(family, port_)) return;
  }
  throw std::system_error(errno, std::generic_category(), "no pair of UDP ports is free");
}

UdpPorts::~UdpPorts() {
  closeAll();
}

void UdpPorts::closeAll() {
  for (int& descriptor : descriptors_) {
    if (descriptor >= 0) close(descriptor);
    descriptor = -1;
  }
}

bool UdpPorts::open(sa_family_t family, std::uint16_t port) {
  for (std::size_t i = 0; i < descriptors_.size(); ++i) {
    sockaddr_storage address{};
    address.ss_family = family;
    setPort(address, static_cast<std::uint16_t>(port + i));
    descriptors_[i] = socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    setsockopt(descriptors_[i], SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
    receivers_[i].begin(descriptors_[i]);
    if (descriptors_[i] >= 0 &&
        bind(descriptors_[i], reinterpret_cast<const sockaddr*>(&address), sizeOf(address)) == 0)
      continue;
    const int error = errno;
    closeAll();
    errno = error;
    return false;
  }
  return true;
}

void UdpPorts::setPeer(const sockaddr_storage& host, std::uint16_t rtp) {
  peer_ = host;
  peer_port_ = rtp;
  for (std::size_t i = 0; rtp != 0 && i < descriptors_.size(); ++i)
    send(i, {});
}

std::optional<std::span<const std::uint8_t>> UdpPorts::receive(std::size_t which) {
  for (int i = 0; i < kMaxForeign; ++i) {
    sockaddr_storage from{};
    const ssize_t length = receivers_[which].receive(descriptors_[which], buffer_, &from);
    if (length < 0 && errno == EINTR) continue;
    if (length < 0) return std::nullopt;
    const bool from_port = peer_port_ != 0 && portOf(from) == peer_port_ + which;
    if (peer_ && (from_port || hasSameHost(from, *peer_)))
      return std::span<const std::uint8_t>(buffer_.data(), static_cast<std::size_t>(length));
    ++foreign_;
    foreign_address_ = from;
  }
  return std::nullopt;
}

std::string UdpPorts::foreignAddress() const {
  return ServerAddress{foreign_address_, sizeOf(foreign_address_)}.text();
}

void UdpPorts::send(std::size_t which, std::span<const std::uint8_t> packet) {
  if (!peer_ || peer_port_ == 0) return;
  sockaddr_storage to = *peer_;
  setPort(to, static_cast<std::uint16_t>(peer_port_ + which));
  sendto(descriptors_[which], packet.data(), packet.size(), MSG_NOSIGNAL,
         reinterpret_cast<const sockaddr*>(&to), sizeOf(to));
}

}  // namespace cartvo::capture
