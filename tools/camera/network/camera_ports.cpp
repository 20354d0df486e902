// Networks of the computer's ports to which the cameras are connected.
#include "tools/camera/network/camera_ports.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>

namespace cartvo {
namespace {

constexpr Ipv4 kHostMask = (Ipv4{1} << (32 - kPortPrefix)) - 1;

Ipv4 maskOf(int prefix) {
  return prefix == 0 ? 0 : ~Ipv4{0} << (32 - prefix);
}

std::string networkText(Ipv4 address) {
  return fmt::format("{}/{}", ipv4Text(address & maskOf(kPortPrefix)), kPortPrefix);
}

/// Names go into the line Name=, where white space separates names and shell patterns are expanded.
void requireInterfaceName(const std::string& name) {
  const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || (c != 0 && std::strchr("-_.:@", c) != nullptr);
  });
  if (name.empty() || name.size() >= IFNAMSIZ || !is_plain || name == "." || name == "..")
    throw std::runtime_error("expected the name of a network interface such as enp2s0, found '" + name +
                             "'; see: ip -brief link");
}

CameraPort portOf(const std::string& side, const std::string& interface, std::vector<Ipv4> cameras) {
  CameraPort port{side, interface, (cameras.front() & maskOf(kPortPrefix)) + 1, std::move(cameras), false};
  while (std::find(port.cameras.begin(), port.cameras.end(), port.address) != port.cameras.end())
    ++port.address;
  return port;
}

CameraPort sharedPort(const PortWishes& wishes) {
  if (!networksOverlap(wishes.left_camera, kPortPrefix, wishes.right_camera, kPortPrefix)) {
    throw std::runtime_error(fmt::format(
        "the cameras at {} and {} are in different networks, but one port has one: give them addresses of "
        "one network, such as {} and {}",
        ipv4Text(wishes.left_camera), ipv4Text(wishes.right_camera), ipv4Text(wishes.left_camera),
        ipv4Text(wishes.left_camera ^ 1)));
  }
  if (wishes.dhcp) {
    throw std::runtime_error(
        "--dhcp needs a port for each camera: at one port the cameras could get each other's address; set a "
        "fixed address in each camera");
  }
  return portOf("both", wishes.interface, {wishes.left_camera, wishes.right_camera});
}

}  // namespace

Ipv4 parseCameraAddress(const std::string& text) {
  in_addr parsed{};
  const bool is_address = ::inet_pton(AF_INET, text.c_str(), &parsed) == 1;
  const Ipv4 address = ntohl(parsed.s_addr);
  const Ipv4 host = address & kHostMask, first = address >> 24;
  constexpr Ipv4 kLoopback = 127, kMulticast = 224;
  if (!is_address || host == 0 || host == kHostMask || first == 0 || first == kLoopback ||
      first >= kMulticast)
    throw std::invalid_argument("expected a camera's IPv4 address such as 192.168.101.64, found '" + text +
                                "'");
  return address;
}

std::string ipv4Text(Ipv4 address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 0xff, address >> 8 & 0xff, address & 0xff);
}

bool networksOverlap(Ipv4 one, int one_prefix, Ipv4 other, int other_prefix) {
  return ((one ^ other) & maskOf(std::min(one_prefix, other_prefix))) == 0;
}

std::vector<CameraPort> planPorts(const PortWishes& wishes) {
  if (wishes.left_camera == wishes.right_camera) {
    throw std::runtime_error("both cameras have the address " + ipv4Text(wishes.left_camera) +
                             ": give each its own");
  }
  if (!wishes.interface.empty()) {
    requireInterfaceName(wishes.interface);
    return {sharedPort(wishes)};
  }
  requireInterfaceName(wishes.left_interface);
  requireInterfaceName(wishes.right_interface);
  if (wishes.left_interface == wishes.right_interface) {
    throw std::runtime_error("both ports are " + wishes.left_interface +
                             ": for both cameras at one port use --interface " + wishes.left_interface);
  }
  if (networksOverlap(wishes.left_camera, kPortPrefix, wishes.right_camera, kPortPrefix)) {
    throw std::runtime_error(
        fmt::format("both cameras are in the network {}, but two ports need two networks: use --left-camera "
                    "192.168.101.64 --right-camera 192.168.102.64, and put these addresses into cameras and "
                    "configuration; or connect both cameras to one port with a switch and use --interface",
                    networkText(wishes.left_camera)));
  }
  std::vector<CameraPort> ports{portOf("left", wishes.left_interface, {wishes.left_camera}),
                                portOf("right", wishes.right_interface, {wishes.right_camera})};
  for (CameraPort& port : ports)
    port.dhcp = wishes.dhcp;
  return ports;
}

std::vector<HostAddress> hostAddresses() {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0)
    throw std::runtime_error(std::string("cannot list interfaces: ") + std::strerror(errno));
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  std::vector<HostAddress> addresses;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET ||
        entry->ifa_netmask == nullptr || (entry->ifa_flags & IFF_LOOPBACK) != 0)
      continue;
    sockaddr_in address{}, mask{};
    std::memcpy(&address, entry->ifa_addr, sizeof address);
    std::memcpy(&mask, entry->ifa_netmask, sizeof mask);
    addresses.push_back(
        {entry->ifa_name, ntohl(address.sin_addr.s_addr), __builtin_popcount(mask.sin_addr.s_addr)});
  }
  return addresses;
}

std::string addressNear(const std::string& camera, const std::vector<HostAddress>& addresses) {
  in_addr parsed{};
  if (::inet_pton(AF_INET, camera.c_str(), &parsed) != 1) return {};
  const auto host = std::find_if(addresses.begin(), addresses.end(), [&](const HostAddress& one) {
    return networksOverlap(one.address, one.prefix, ntohl(parsed.s_addr), one.prefix);
  });
  return host != addresses.end() ? ipv4Text(host->address) : std::string();
}

std::vector<std::string> overlapsWithHost(const std::vector<CameraPort>& ports,
                                          const std::vector<HostAddress>& addresses) {
  std::vector<std::string> overlaps;
  for (const HostAddress& host : addresses) {
    const bool is_port = std::any_of(
        ports.begin(), ports.end(), [&](const CameraPort& port) { return port.interface == host.interface; });
    if (is_port) continue;
    for (const CameraPort& port : ports) {
      if (!networksOverlap(port.address, kPortPrefix, host.address, host.prefix)) continue;
      overlaps.push_back(fmt::format(
          "the network {} of {} overlaps {}/{} of {}, so this computer would send to the wrong one: give the "
          "camera an address of another network",
          networkText(port.address), port.interface, ipv4Text(host.address), host.prefix, host.interface));
    }
  }
  return overlaps;
}

std::vector<std::string> lostAddresses(const std::vector<CameraPort>& ports,
                                       const std::vector<HostAddress>& addresses) {
  std::vector<std::string> lost;
  for (const HostAddress& host : addresses) {
    for (const CameraPort& port : ports) {
      if (port.interface != host.interface ||
          networksOverlap(port.address, kPortPrefix, host.address, host.prefix))
        continue;
      lost.push_back(fmt::format("{} has the address {}/{} now, which it loses: is it the port of a camera?",
                                 host.interface, ipv4Text(host.address), host.prefix));
    }
  }
  return lost;
}

}  // namespace cartvo
