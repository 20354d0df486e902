// Texts of the files that configure the computer's network for the cameras.
#include "tools/camera/network/network_files.hpp"

#include <fmt/format.h>

namespace cartvo {
namespace {

constexpr Ipv4 kHostMask = (Ipv4{1} << (32 - kPortPrefix)) - 1;

std::string fileName(const CameraPort& port) {
  return port.side == "both" ? "10-cartvo-cameras.network" : "10-cartvo-" + port.side + ".network";
}

std::string camerasText(const CameraPort& port) {
  return port.side == "both" ? "both cameras" : "the " + port.side + " camera";
}

std::string cameraAddresses(const CameraPort& port) {
  std::string text;
  for (const Ipv4 camera : port.cameras)
    text += (text.empty() ? "" : " and ") + ipv4Text(camera);
  return text;
}

std::string addressPart(const CameraPort& port) {
  if (!port.dhcp) {
    return fmt::format(
        "\n# {}: set {} and the netmask 255.255.255.0 in the camera{}, and no gateway.\nDHCPServer=no\n",
        port.cameras.size() == 1 ? "The camera's address" : "The addresses of the cameras",
        cameraAddresses(port), port.cameras.size() == 1 ? "" : "s");
  }
  return fmt::format(
      R"(
# Gives the camera the address {}, the only one of the pool, and no gateway or name server. Without this line and
# the section below set the address in the camera.
DHCPServer=yes

[DHCPServer]
PoolOffset={}
PoolSize=1
EmitDNS=no
EmitNTP=yes
NTP={}
EmitRouter=no
EmitTimezone=no
)",
      cameraAddresses(port), port.cameras.front() & kHostMask, ipv4Text(port.address));
}

NetworkFile portFile(const CameraPort& port) {
  const std::filesystem::path place = "systemd/network/" + fileName(port);
  return {place, fmt::format(
                     R"(# Port of {}. Install as /etc/{}, check Name=, then run: networkctl reload
# systemd-networkd must run (systemctl enable --now systemd-networkd), and no other program may configure this interface.

[Match]
# The interface's name, as ip link prints it; better MACAddress=, which stays the same if the hardware changes.
Name={}

[Link]
# cartvod waits for cameras itself: starting the computer does not wait for this port.
RequiredForOnline=no-carrier

[Network]
# The camera's network. No gateway: there is no default route through this port.
Address={}/{}
# The address stays while the camera is off.
ConfigureWithoutCarrier=yes
DHCP=no
IPv6AcceptRA=no
LinkLocalAddressing=no
LLMNR=no
MulticastDNS=no
{})",
                     camerasText(port), place.string(), port.interface, ipv4Text(port.address), kPortPrefix,
                     addressPart(port))};
}

NetworkFile timeFile(const std::vector<CameraPort>& ports) {
  std::string networks;
  for (const CameraPort& port : ports)
    networks += fmt::format("allow {}/{}\n", ipv4Text(port.address & ~kHostMask), kPortPrefix);
  return {
      "chrony/conf.d/cartvo-cameras.conf",
      fmt::format(
          R"(# chrony serves this computer's time to the cameras. Install as /etc/chrony/conf.d/cartvo-cameras.conf, then run:
# systemctl restart chrony
# In each camera set the time mode NTP, the address of its port as the server, and the shortest interval.

# The networks of the ports of the cameras; no other host is served.
{}
# Serves also while this computer has no time source, as on a cart without internet. The cameras then agree with each other
# and with this computer, which is what the odometry needs.
local stratum 10
)",
          networks)};
}

NetworkFile buffersFile() {
  return {
      "sysctl.d/60-cartvo-buffers.conf",
      R"(# Lets programs ask for receive buffers of up to 4 MB, so that a burst of packets is not lost while a program waits for the
# processor. cartvod asks for 2 MB for each camera with cameras.transport: udp; a subscriber of LCM asks by recv_buf_size in
# its URL. Install as /etc/sysctl.d/60-cartvo-buffers.conf, then run: sysctl --system
net.core.rmem_max = 4194304
)"};
}

}  // namespace

std::vector<NetworkFile> networkFiles(const std::vector<CameraPort>& ports) {
  std::vector<NetworkFile> files;
  for (const CameraPort& port : ports)
    files.push_back(portFile(port));
  files.push_back(timeFile(ports));
  files.push_back(buffersFile());
  return files;
}

std::string nextSteps(const std::vector<CameraPort>& ports) {
  std::string text =
      "  sudo systemctl enable --now systemd-networkd && sudo networkctl reload\n"
      "  sudo apt install chrony && sudo systemctl restart chrony\n"
      "  sudo sysctl --system\n";
  for (const CameraPort& port : ports) {
    text += port.dhcp ? fmt::format("In {}: DHCP on (it gets {}), ", camerasText(port), cameraAddresses(port))
                      : fmt::format("In {}: address {}, netmask 255.255.255.0, no gateway, ",
                                    camerasText(port), cameraAddresses(port));
    text += fmt::format("time by NTP from {}.\n", ipv4Text(port.address));
  }
  return text +
         "In the configuration: these addresses in cameras.left.url and cameras.right.url. Then: cartvo "
         "doctor\n";
}

}  // namespace cartvo
