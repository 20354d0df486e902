#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Messages of ONVIF WS-Discovery and of SADP, Hikvision's own discovery.

namespace cartvo {

/// A device that answered. All texts are printable, and empty where the device does not say.
struct DiscoveredDevice {
  std::string address;  ///< IPv4, as the device states it; for ONVIF the host of its service
  std::string model, serial_number, mac_address, firmware;
  std::string subnet_mask, gateway;
  std::string http_port;
  std::optional<bool> dhcp;
  std::optional<bool> activated;       ///< false: it has no password yet and streams nothing
  std::vector<std::string> protocols;  ///< "SADP", "ONVIF"
};

/// The question of SADP.
std::string sadpProbe(const std::string& uuid);

/// The question of WS-Discovery for video devices.
std::string onvifProbe(const std::string& uuid);

/// The device of a SADP answer; nothing if the datagram is none.
std::optional<DiscoveredDevice> parseSadpAnswer(std::string_view datagram);

/// The devices of a WS-Discovery answer; none if the datagram is none.
std::vector<DiscoveredDevice> parseOnvifAnswer(std::string_view datagram);

/// Adds a device to a list, or what it says to the entry with the same address.
void mergeDevice(std::vector<DiscoveredDevice>& devices, const DiscoveredDevice& device);

}  // namespace cartvo
