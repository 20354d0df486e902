// Sends LCM messages by a socket of its own, because LCM does not let its users choose the interface.
#include "daemon/publish/message_sender.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/lcm_url.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::uint32_t kMagic = 0x4c433032;  // "LC02": a message of one datagram

std::string errorText() {
  return std::generic_category().message(errno);
}

void append(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(number >> static_cast<unsigned>(shift)));
}

/// Sends by the loopback interface and joins the group there. False: errno says why not.
bool stayOnHost(int descriptor, const in_addr& group) {
  ip_mreqn loopback{group, {}, static_cast<int>(if_nametoindex("lo"))};
  return loopback.imr_ifindex != 0 &&
         setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback) == 0 &&
         setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &loopback, sizeof loopback) == 0;
}

/// A socket connected to nothing but set to send to the group: one that is connected keeps its first route.
int openSocket(const LcmGroup& group) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) throw std::runtime_error("LCM: cannot open a socket: " + errorText());
  in_addr address{};
  inet_pton(AF_INET, group.address.c_str(), &address);
  const bool is_ready =
      setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_TTL, &group.ttl, sizeof group.ttl) == 0 &&
      (group.ttl > 0 || stayOnHost(descriptor, address));
  if (is_ready) return descriptor;
  const std::string reason = errorText();
  close(descriptor);
  throw std::runtime_error("LCM cannot send to " + group.url() + ": " + reason);
}

}  // namespace

GroupSender::GroupSender(const std::string& url) : socket_(-1) {
  requireMulticastRoute(url);
  const LcmGroup group = parseLcmUrl(url);
  socket_ = openSocket(group);
  destination_.sin_family = AF_INET;
  destination_.sin_port = htons(static_cast<std::uint16_t>(group.port));
  inet_pton(AF_INET, group.address.c_str(), &destination_.sin_addr);
}

GroupSender::~GroupSender() {
  close(socket_);
}

bool GroupSender::send(const std::string& channel, const std::vector<std::uint8_t>& message) {
  datagram_.clear();
  append(datagram_, kMagic);
  append(datagram_, sequence_++);
  datagram_.insert(datagram_.end(), channel.begin(), channel.end());
  datagram_.push_back(0);
  datagram_.insert(datagram_.end(), message.begin(), message.end());
  const ssize_t sent = sendto(socket_, datagram_.data(), datagram_.size(), MSG_DONTWAIT,
                              reinterpret_cast<const sockaddr*>(&destination_), sizeof destination_);
  if (sent < 0) error_ = errorText();
  return sent >= 0;
}

}  // namespace cartvo::daemon
