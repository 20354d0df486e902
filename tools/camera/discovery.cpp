// Searches cameras by multicast.
#include "tools/camera/discovery.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <random>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxDevices = 256;
constexpr int kProbes = 3;  // UDP may lose one

/// UDP socket of one protocol on one interface.
class ProbeSocket {
 public:
  ProbeSocket() : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    if (descriptor_ < 0)
      throw std::runtime_error(std::string("cannot open a UDP socket: ") + std::strerror(errno));
  }
  ~ProbeSocket() { ::close(descriptor_); }
  ProbeSocket(const ProbeSocket&) = delete;
  ProbeSocket& operator=(const ProbeSocket&) = delete;

  /// Sends by the interface with this address. `port`: where answers to the group are received; where it is
  /// taken, only those to this socket are.
  void attach(const in_addr& interface, const in_addr& group, std::uint16_t port) const {
    const int on = 1;
    const unsigned char hops = 1;
    ::setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    ::setsockopt(descriptor_, IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface);
    ::setsockopt(descriptor_, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof hops);
    if (port == 0) return;
    sockaddr_in local{};
    local.sin_family = AF_INET;
    local.sin_port = htons(port);
    if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&local), sizeof local) != 0) return;
    const ip_mreq membership{group, interface};
    ::setsockopt(descriptor_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership);
  }

  bool send(const std::string& text, const in_addr& group, std::uint16_t port) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr = group;
    address.sin_port = htons(port);
    return ::sendto(descriptor_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&address),
                    sizeof address) == static_cast<ssize_t>(text.size());
  }

  /// The next datagram; empty if there is none.
  std::string receive() const {
    std::array<char, 65536> buffer{};
    const ssize_t size = ::recv(descriptor_, buffer.data(), buffer.size(), 0);
    return size > 0 ? std::string(buffer.data(), static_cast<std::size_t>(size)) : std::string();
  }

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

struct Interface {
  std::string name;
  in_addr address{};
};

std::vector<Interface> interfacesOf(const DiscoverySettings& settings) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0)
    throw std::runtime_error(std::string("cannot list interfaces: ") + std::strerror(errno));
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  std::vector<Interface> interfaces;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET ||
        (entry->ifa_flags & IFF_UP) == 0)
      continue;
    const bool is_named = std::find(settings.interfaces.begin(), settings.interfaces.end(),
                                    entry->ifa_name) != settings.interfaces.end();
    const bool is_usual = (entry->ifa_flags & IFF_LOOPBACK) == 0 && (entry->ifa_flags & IFF_MULTICAST) != 0;
    if (settings.interfaces.empty() ? !is_usual : !is_named) continue;
    sockaddr_in address{};
    std::memcpy(&address, entry->ifa_addr, sizeof address);
    interfaces.push_back({entry->ifa_name, address.sin_addr});
  }
  for (const std::string& name : settings.interfaces) {
    const bool is_there = std::any_of(interfaces.begin(), interfaces.end(),
                                      [&](const Interface& interface) { return interface.name == name; });
    if (!is_there)
      throw std::runtime_error("the interface " + name +
                               " does not exist, is down, or has no IPv4 address; see: ip address");
  }
  return interfaces;
}

/// A random identifier (RFC 4122, version 4).
std::string randomUuid() {
  std::random_device device;
  const auto bits = [&](std::uint32_t mask) { return device() & mask; };
  return fmt::format("{:08X}-{:04X}-4{:03X}-{:X}{:03X}-{:04X}{:08X}", bits(0xffffffff), bits(0xffff),
                     bits(0xfff), 8U + bits(3), bits(0xfff), bits(0xffff), bits(0xffffffff));
}

/// One protocol on one interface.
struct Search {
  bool is_sadp = false;
  ProbeSocket socket;
};

using Searches = std::vector<std::unique_ptr<Search>>;

/// False if nothing could be sent.
bool probe(const Searches& searches, const DiscoverySettings& settings, const in_addr& group,
           const std::string& uuid) {
  bool is_sent = false;
  for (const auto& search : searches) {
    const bool sent = search->is_sadp ? search->socket.send(sadpProbe(uuid), group, settings.sadp_port)
                                      : search->socket.send(onvifProbe(uuid), group, settings.onvif_port);
    is_sent = is_sent || sent;
  }
  return is_sent;
}

void collect(const Searches& searches, Clock::time_point until, std::vector<DiscoveredDevice>& devices) {
  std::vector<pollfd> polled;
  for (const auto& search : searches)
    polled.push_back({search->socket.descriptor(), POLLIN, 0});
  for (Clock::time_point now = Clock::now(); now < until; now = Clock::now()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - now).count() + 1;
    if (::poll(polled.data(), polled.size(), static_cast<int>(left)) <= 0) continue;
    for (const auto& search : searches) {
      const std::string datagram = search->socket.receive();
      if (datagram.empty() || devices.size() >= kMaxDevices) continue;
      if (search->is_sadp) {
        if (const auto device = parseSadpAnswer(datagram)) mergeDevice(devices, *device);
      } else {
        for (const DiscoveredDevice& device : parseOnvifAnswer(datagram))
          mergeDevice(devices, device);
      }
    }
  }
}

}  // namespace

std::vector<DiscoveredDevice> discoverDevices(const DiscoverySettings& settings) {
  in_addr group{};
  if (::inet_pton(AF_INET, settings.group.c_str(), &group) != 1)
    throw std::runtime_error("expected an IPv4 address of a group, found " + settings.group);
  Searches searches;
  for (const Interface& interface : interfacesOf(settings)) {
    for (const bool is_sadp : {true, false}) {
      searches.push_back(std::make_unique<Search>());
      searches.back()->is_sadp = is_sadp;
      const bool is_multicast = IN_MULTICAST(ntohl(group.s_addr));
      searches.back()->socket.attach(interface.address, group,
                                     is_sadp && is_multicast ? settings.sadp_port : 0);
    }
  }
  if (searches.empty())
    throw std::runtime_error(
        "no interface is up that can multicast; connect the cameras, or name one with --interface");
  std::vector<DiscoveredDevice> devices;
  const std::string uuid = randomUuid();
  const Clock::time_point start = Clock::now();
  for (int i = 1; i <= kProbes; ++i) {
    if (!probe(searches, settings, group, uuid) && i == 1)
      throw std::runtime_error(std::string("nothing can be sent to ") + settings.group + ": " +
                               std::strerror(errno));
    collect(searches, start + settings.duration * i / kProbes, devices);
  }
  std::sort(devices.begin(), devices.end(), [](const DiscoveredDevice& one, const DiscoveredDevice& other) {
    return std::pair(ntohl(inet_addr(one.address.c_str())), one.mac_address) <
           std::pair(ntohl(inet_addr(other.address.c_str())), other.mac_address);
  });
  return devices;
}

}  // namespace cartvo
