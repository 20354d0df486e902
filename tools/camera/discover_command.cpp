// `cartvo camera discover`: searches cameras on the network.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/command_line/parser.hpp"
#include "tools/camera/actions.hpp"
#include "tools/camera/discovery.hpp"
#include "tools/cartvo/json_text.hpp"

namespace cartvo {
namespace {

struct Options {
  std::vector<std::string> interfaces;
  double seconds = 3.0;
  bool json = false;
};

std::string deviceText(const DiscoveredDevice& device) {
  std::string text = fmt::format("{:<15}  {:<17}  {:<24} {}", device.address, device.mac_address,
                                 device.model, fmt::join(device.protocols, ", "));
  if (!device.firmware.empty()) text += ", firmware " + device.firmware;
  if (!device.http_port.empty() && device.http_port != "80") text += ", HTTP port " + device.http_port;
  if (device.dhcp == true) text += ", address by DHCP";
  if (device.activated == false)
    text += "\n                 not activated: it streams nothing until it gets a password in its web page";
  return text + "\n";
}

nlohmann::json deviceJson(const DiscoveredDevice& device) {
  nlohmann::json json{{"address", device.address},
                      {"model", device.model},
                      {"serial_number", device.serial_number},
                      {"mac_address", device.mac_address},
                      {"firmware", device.firmware},
                      {"subnet_mask", device.subnet_mask},
                      {"gateway", device.gateway},
                      {"http_port", device.http_port},
                      {"protocols", device.protocols}};
  json["dhcp"] = device.dhcp ? nlohmann::json(*device.dhcp) : nlohmann::json();
  json["activated"] = device.activated ? nlohmann::json(*device.activated) : nlohmann::json();
  return json;
}

void run(const Options& options) {
  DiscoverySettings settings;
  settings.interfaces = options.interfaces;
  settings.duration = std::chrono::milliseconds(std::llround(1e3 * options.seconds));
  const std::vector<DiscoveredDevice> devices = discoverDevices(settings);
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (const DiscoveredDevice& device : devices) {
    list.push_back(deviceJson(device));
    text += deviceText(device);
  }
  std::fputs((options.json ? jsonText(list) : text).c_str(), stdout);
  if (!devices.empty()) return;
  std::fputs(
      "cartvo: no camera answered: is it powered and on this interface, and does no firewall drop UDP?\n",
      stderr);
  std::fflush(stdout);
  throw ExitCode(EXIT_FAILURE);
}

}  // namespace

void addDiscoverAction(Command camera) {
  const Command action = camera.addSubcommand("discover", "Search cameras on the network (ONVIF and SADP)");
  const auto options = std::make_shared<Options>();
  action
      .addOption("--interface", options->interfaces,
                 "Network interface of the cameras; may be repeated (default: all that are up)")
      .typeName("NAME");
  action.addOption("--seconds", options->seconds, "How long to wait for answers")
      .range(0.1, 60.0)
      .captureDefault();
  action.addFlag("--json", options->json, "Print JSON");
  action.footer(
      "Cameras are asked and not changed. Exit codes: 0 a camera answered, 1 none did, 2 wrong command "
      "line.");
  action.callback([options] { run(*options); });
}

}  // namespace cartvo
