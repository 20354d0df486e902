#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/camera/discovery_messages.hpp"

namespace cartvo {

/// How cameras are searched.
struct DiscoverySettings {
  std::vector<std::string> interfaces;  ///< names; empty: all that are up and can multicast, without loopback
  std::chrono::milliseconds duration{3000};
  // Addresses of the protocols.
  std::string group = "239.255.255.250";
  std::uint16_t sadp_port = 37020;
  std::uint16_t onvif_port = 3702;
};

/// Asks by SADP and WS-Discovery on each interface, and collects answers until the time has passed. Changes
/// nothing on any device. Throws std::runtime_error if there is no such interface or nothing can be sent on
/// any.
std::vector<DiscoveredDevice> discoverDevices(const DiscoverySettings& settings);

}  // namespace cartvo
