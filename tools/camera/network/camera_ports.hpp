#pragma once

#include <cstdint>
#include <string>
#include <vector>

// Networks of the computer's ports to which the cameras are connected.

namespace cartvo {

/// An IPv4 address as a number: 192.168.1.64 is 0xC0A80140.
using Ipv4 = std::uint32_t;

/// Bits of a port's network that all its hosts share: netmask 255.255.255.0.
constexpr int kPortPrefix = 24;

/// Throws std::invalid_argument unless `text` is an IPv4 address that a camera can have.
Ipv4 parseCameraAddress(const std::string& text);

std::string ipv4Text(Ipv4 address);

/// Whether two networks have an address in common.
bool networksOverlap(Ipv4 one, int one_prefix, Ipv4 other, int other_prefix);

/// Ports and cameras that the user wants. Either `interface` or both other interfaces are set.
struct PortWishes {
  std::string interface;  ///< one port, with a switch and both cameras
  std::string left_interface, right_interface;
  Ipv4 left_camera = 0, right_camera = 0;
  bool dhcp = false;  ///< each port gives its camera the address
};

/// A port of the computer.
struct CameraPort {
  std::string side;  ///< "left", "right" or "both"
  std::string interface;
  Ipv4 address = 0;  ///< of the port
  std::vector<Ipv4> cameras;
  bool dhcp = false;
};

/// The ports with their addresses: the first one of the cameras' network that no camera has. Throws
/// std::runtime_error, with what to do, if a name is none of an interface, if the cameras' addresses do not
/// suit the ports, or if DHCP would have to tell two cameras apart.
std::vector<CameraPort> planPorts(const PortWishes& wishes);

/// An address of an interface of this computer.
struct HostAddress {
  std::string interface;
  Ipv4 address = 0;
  int prefix = 0;  ///< bits
};

/// The IPv4 addresses of this computer, except those of the loopback interface. Throws std::runtime_error if
/// they cannot be listed.
std::vector<HostAddress> hostAddresses();

/// This computer's address in the network of `camera`, an IPv4 address; empty if it has none there or
/// `camera` is a name.
std::string addressNear(const std::string& camera, const std::vector<HostAddress>& addresses);

/// For each port whose network overlaps that of another interface: what overlaps, and what to do. A port's
/// own addresses do not count.
std::vector<std::string> overlapsWithHost(const std::vector<CameraPort>& ports,
                                          const std::vector<HostAddress>& addresses);

/// For each address of another network that a port has now: that it loses it.
std::vector<std::string> lostAddresses(const std::vector<CameraPort>& ports,
                                       const std::vector<HostAddress>& addresses);

}  // namespace cartvo
