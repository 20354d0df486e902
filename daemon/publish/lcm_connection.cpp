// Connects to LCM and checks the route of its multicast packets: a wrong route is the commonest reason for
// missing messages.

#include "daemon/publish/lcm_connection.hpp"

#include <array>
#include <cstring>
#include <regex>
#include <stdexcept>

#include <arpa/inet.h>
#include <lcm/lcm-cpp.hpp>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo::daemon {
namespace {

struct GroupUrl {
  std::string address;
  int port = 0;
  int ttl = 0;
};

GroupUrl parseGroupUrl(const std::string& url) {
  static const std::regex kUrl(R"(udpm://([0-9.]+):([0-9]{1,5})(\?(.*))?)");
  static const std::regex kTtl("(^|&)ttl=([0-9]{1,3})(&|$)");
  std::smatch parts;
  if (!std::regex_match(url, parts, kUrl)) {
    throw std::invalid_argument("'" + url + "' is not an LCM URL such as udpm://239.255.76.67:7667?ttl=0");
  }
  GroupUrl group{parts[1], std::stoi(parts[2]), 0};
  const std::string options = parts[4];
  std::smatch ttl;
  if (std::regex_search(options, ttl, kTtl)) group.ttl = std::stoi(ttl[2]);
  in_addr parsed{};
  if (inet_pton(AF_INET, group.address.c_str(), &parsed) != 1 || !IN_MULTICAST(ntohl(parsed.s_addr))) {
    throw std::invalid_argument("'" + group.address + "' is not a multicast address (224.0.0.0/4)");
  }
  if (group.port < 1 || group.port > 65535)
    throw std::invalid_argument("'" + url + "': the port must be from 1 to 65535");
  return group;
}

/// Index of the interface by which packets to `destination` leave (rtnetlink(7), RTM_GETROUTE, as in
/// `ip route get`); 0 if there is no route. The local address of a connected socket does not identify it: on
/// a route through `lo` it is another interface's address.
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

  const int descriptor = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (descriptor < 0) return 0;
  alignas(nlmsghdr) std::array<char, 4096> response{};
  ssize_t received = -1;
  if (send(descriptor, &request, sizeof request, 0) == static_cast<ssize_t>(sizeof request)) {
    received = recv(descriptor, response.data(), response.size(), 0);
  }
  close(descriptor);

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
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
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

void checkLcmUrl(const std::string& url) {
  parseGroupUrl(url);
}

std::string multicastGroup(const std::string& url) {
  const GroupUrl group = parseGroupUrl(url);
  return group.address + ":" + std::to_string(group.port);
}

MulticastRoute findMulticastRoute(const std::string& url) {
  const GroupUrl group = parseGroupUrl(url);
  MulticastRoute route{group.address, "", false, group.ttl};
  std::array<char, IF_NAMESIZE> name{};
  const unsigned index = outgoingInterface(group.address);
  if (index == 0 || if_indextoname(index, name.data()) == nullptr) return route;
  route.interface = name.data();
  route.loopback = isLoopback(route.interface);
  return route;
}

std::unique_ptr<lcm::LCM> connectLcm(const std::string& url) {
  const MulticastRoute route = findMulticastRoute(url);
  if (route.interface.empty()) {
    throw std::runtime_error("LCM: this host has no route for the multicast group " + route.address + ". " +
                             howToAddRoute(route.address));
  }
  auto lcm = std::make_unique<lcm::LCM>(url);
  if (!lcm->good()) {
    throw std::runtime_error("LCM cannot use " + url + " over " + route.interface + ". " +
                             howToAddRoute(route.address));
  }
  return lcm;
}

std::string multicastWarning(const MulticastRoute& route) {
  if (route.loopback && route.ttl > 0) {
    return "LCM's URL has ttl=" + std::to_string(route.ttl) + ", but its route goes through " +
           route.interface + ": no other host receives these messages";
  }
  if (!route.loopback && route.ttl == 0) {
    return "LCM's URL keeps messages on this host (ttl=0), but its route goes through " + route.interface +
           ": messages stop when that link goes down. " + howToAddRoute(route.address);
  }
  return {};
}

}  // namespace cartvo::daemon
