// Connects to LCM and checks the route of its multicast packets: a wrong route is the commonest reason for
// missing messages.

#include "daemon/publish/lcm_connection.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <arpa/inet.h>
#include <lcm/lcm-cpp.hpp>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/publish/lcm_url.hpp"

namespace cartvo::daemon {
namespace {

[[noreturn]] void failToAsk(int error) {
  throw std::system_error(error, std::generic_category(), "LCM: the multicast route cannot be looked up");
}

int openSocket(int family, int type, int protocol) {
  const int descriptor = socket(family, type | SOCK_CLOEXEC, protocol);
  if (descriptor < 0) failToAsk(errno);
  return descriptor;
}

/// Index of the interface by which packets to `destination` leave (rtnetlink(7), RTM_GETROUTE, as in
/// `ip route get`); 0 if there is no route. The local address of a connected socket does not identify it: on
/// a route through `lo` it is another interface's address. Throws std::system_error if the kernel cannot be
/// asked.
unsigned outgoingInterface(const std::string& destination) {
  struct {
    nlmsghdr header{};
    rtmsg route{};
    rtattr attribute{};
    in_addr address{};
  } request;
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETROUTE;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.route.rtm_family = AF_INET;
  request.route.rtm_dst_len = 32;
  request.attribute.rta_type = RTA_DST;
  request.attribute.rta_len = RTA_LENGTH(sizeof request.address);
  inet_pton(AF_INET, destination.c_str(), &request.address);

  const int descriptor = openSocket(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE);
  alignas(nlmsghdr) std::array<char, 4096> response{};
  ssize_t received = send(descriptor, &request, sizeof request, 0);
  if (received >= 0) received = recv(descriptor, response.data(), response.size(), 0);
  const int error = errno;
  close(descriptor);
  if (received < 0) failToAsk(error);

  const auto* header = reinterpret_cast<const nlmsghdr*>(response.data());
  if (received < static_cast<ssize_t>(sizeof(nlmsghdr)) || header->nlmsg_type != RTM_NEWROUTE) return 0;
  const auto* route = reinterpret_cast<const rtmsg*>(NLMSG_DATA(header));
  auto left = static_cast<int>(RTM_PAYLOAD(header));
  for (const rtattr* entry = RTM_RTA(route); RTA_OK(entry, left); entry = RTA_NEXT(entry, left)) {
    if (entry->rta_type != RTA_OIF) continue;
    unsigned index = 0;
    std::memcpy(&index, RTA_DATA(entry), sizeof index);
    return index;
  }
  return 0;
}

bool isLoopback(const std::string& interface) {
  const int descriptor = openSocket(AF_INET, SOCK_DGRAM, 0);
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  const bool known = ioctl(descriptor, SIOCGIFFLAGS, &request) == 0;
  close(descriptor);
  return known && (request.ifr_flags & IFF_LOOPBACK) != 0;
}

std::string howToAddRoute(const std::string& address) {
  return "To keep LCM on this host, as root: 'ip link set lo multicast on; ip route add " + address +
         "/32 dev lo' (cartvo-multicast.service does it at boot). To reach other hosts: use the network's "
         "interface instead of lo, and ttl=1 in the URL";
}

}  // namespace

MulticastRoute findMulticastRoute(const std::string& url) {
  const LcmGroup group = parseLcmUrl(url);
  MulticastRoute route{group.address, "", false, group.ttl};
  std::array<char, IF_NAMESIZE> name{};
  const unsigned index = outgoingInterface(group.address);
  if (index == 0 || if_indextoname(index, name.data()) == nullptr) return route;
  route.interface = name.data();
  route.loopback = isLoopback(route.interface);
  return route;
}

MulticastRoute requireMulticastRoute(const std::string& url) {
  MulticastRoute route = findMulticastRoute(url);
  if (!route.interface.empty()) return route;
  throw std::runtime_error("LCM: this host has no route for the multicast group " + route.address + ". " +
                           howToAddRoute(route.address));
}

std::unique_ptr<lcm::LCM> connectLcm(const std::string& url) {
  const MulticastRoute route = requireMulticastRoute(url);
  errno = 0;
  auto lcm = std::make_unique<lcm::LCM>(parseLcmUrl(url).url());
  if (!lcm->good()) {
    if (errno == EMFILE || errno == ENFILE)
      throw std::system_error(errno, std::generic_category(), "LCM cannot be opened");
    throw std::runtime_error("LCM cannot use " + describeLcmUrl(url) + " over " + route.interface + ". " +
                             howToAddRoute(route.address));
  }
  return lcm;
}

std::string multicastWarning(const MulticastRoute& route) {
  if (route.interface.empty()) {
    return "the route for LCM's multicast group " + route.address + " is gone: " +
           (route.ttl == 0 ? "programs that start now cannot subscribe" : "messages are not sent") + ". " +
           howToAddRoute(route.address);
  }
  if (route.loopback && route.ttl > 0) {
    return "LCM's URL has ttl=" + std::to_string(route.ttl) + ", but its route goes through " +
           route.interface + ": no other host receives these messages";
  }
  if (!route.loopback && route.ttl == 0) {
    return "LCM's URL keeps messages on this host (ttl=0), but its route goes through " + route.interface +
           ": cartvod sends through lo, but programs in Java, such as lcm-spy, receive nothing, and no "
           "program "
           "can subscribe when that link is down. " +
           howToAddRoute(route.address);
  }
  return {};
}

}  // namespace cartvo::daemon
