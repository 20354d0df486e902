// Messages of ONVIF WS-Discovery and of SADP.
#include "tools/camera/discovery_messages.hpp"

#include <algorithm>
#include <sstream>

#include "capture/isapi/xml_document.hpp"
#include "common/ascii_text.hpp"
#include "common/http/listen_address.hpp"
#include "common/printable_text.hpp"

namespace cartvo {
namespace {

using capture::XmlDocument;

std::optional<XmlDocument> documentOf(std::string_view datagram) {
  // Some devices put a binary head before the XML.
  const std::size_t begin = datagram.find('<');
  if (begin == std::string_view::npos) return std::nullopt;
  return XmlDocument::parseIfXml(datagram.substr(begin));
}

std::string textOf(const XmlDocument& document, const char* name) {
  return printableExcerpt(document.anyText(name).value_or(""), 120);
}

/// Host of "http://HOST[:PORT]/PATH"; empty for other text.
std::string hostOf(const std::string& url) {
  constexpr std::string_view kBefore = "://";
  const std::size_t begin = url.find(kBefore);
  if (begin == std::string::npos) return {};
  const std::string rest = url.substr(begin + kBefore.size());
  if (rest.starts_with('[')) return rest.substr(1, rest.find(']') - 1);
  return rest.substr(0, rest.find_first_of(":/"));
}

/// Value of a scope such as onvif://www.onvif.org/hardware/DS-2CD2143G2-I.
std::string scopeOf(const std::string& scopes, const std::string& kind) {
  std::istringstream words(scopes);
  const std::string before = "onvif://www.onvif.org/" + kind + "/";
  for (std::string word; words >> word;)
    if (lowerCase(word).starts_with(lowerCase(before))) return word.substr(before.size());
  return {};
}

void fill(std::string& text, const std::string& other) {
  if (text.empty()) text = other;
}

}  // namespace

std::string sadpProbe(const std::string& uuid) {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?><Probe><Uuid>" + uuid +
         "</Uuid><Types>inquiry</Types></Probe>";
}

std::string onvifProbe(const std::string& uuid) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>"
         "<e:Envelope xmlns:e=\"http://www.w3.org/2003/05/soap-envelope\" "
         "xmlns:w=\"http://schemas.xmlsoap.org/ws/2004/08/addressing\" "
         "xmlns:d=\"http://schemas.xmlsoap.org/ws/2005/04/discovery\" "
         "xmlns:dn=\"http://www.onvif.org/ver10/network/wsdl\"><e:Header><w:MessageID>uuid:" +
         uuid +
         "</w:MessageID><w:To e:mustUnderstand=\"true\">urn:schemas-xmlsoap-org:ws:2005:04:discovery</w:To>"
         "<w:Action "
         "e:mustUnderstand=\"true\">http://schemas.xmlsoap.org/ws/2005/04/discovery/Probe</w:Action>"
         "</e:Header><e:Body><d:Probe><d:Types>dn:NetworkVideoTransmitter</d:Types></d:Probe></e:Body></"
         "e:Envelope>";
}

std::optional<DiscoveredDevice> parseSadpAnswer(std::string_view datagram) {
  const std::optional<XmlDocument> document = documentOf(datagram);
  if (!document || document->rootName() != "ProbeMatch") return std::nullopt;
  DiscoveredDevice device;
  device.address = textOf(*document, "IPv4Address");
  if (!isIpv4Address(device.address)) return std::nullopt;
  device.model = textOf(*document, "DeviceDescription");
  device.serial_number = textOf(*document, "DeviceSN");
  device.mac_address = lowerCase(textOf(*document, "MAC"));
  std::replace(device.mac_address.begin(), device.mac_address.end(), '-', ':');
  device.firmware = textOf(*document, "SoftwareVersion");
  device.subnet_mask = textOf(*document, "IPv4SubnetMask");
  if (device.subnet_mask.empty()) device.subnet_mask = textOf(*document, "SubnetMask");
  device.gateway = textOf(*document, "IPv4Gateway");
  if (device.gateway.empty()) device.gateway = textOf(*document, "Gateway");
  device.http_port = textOf(*document, "HttpPort");
  device.dhcp = document->anyTruth("DHCP");
  device.activated = document->anyTruth("Activated");
  device.protocols = {"SADP"};
  return device;
}

std::vector<DiscoveredDevice> parseOnvifAnswer(std::string_view datagram) {
  std::vector<DiscoveredDevice> devices;
  const std::optional<XmlDocument> document = documentOf(datagram);
  if (!document) return devices;
  for (const XmlDocument& match : document->parts("ProbeMatch")) {
    DiscoveredDevice device;
    std::istringstream addresses(match.anyText("XAddrs").value_or(""));
    for (std::string url; addresses >> url && !isIpv4Address(device.address);)
      device.address = hostOf(url);
    if (!isIpv4Address(device.address)) continue;
    const std::string scopes = match.anyText("Scopes").value_or("");
    device.model = printableExcerpt(scopeOf(scopes, "hardware"));
    device.mac_address = lowerCase(printableExcerpt(scopeOf(scopes, "MAC")));
    device.protocols = {"ONVIF"};
    devices.push_back(std::move(device));
  }
  return devices;
}

void mergeDevice(std::vector<DiscoveredDevice>& devices, const DiscoveredDevice& device) {
  const auto same = std::find_if(devices.begin(), devices.end(), [&](const DiscoveredDevice& known) {
    // Cameras as they come out of the box share one address.
    const bool is_other =
        !known.mac_address.empty() && !device.mac_address.empty() && known.mac_address != device.mac_address;
    return known.address == device.address && !is_other;
  });
  if (same == devices.end()) {
    devices.push_back(device);
    return;
  }
  for (const auto member :
       {&DiscoveredDevice::model, &DiscoveredDevice::serial_number, &DiscoveredDevice::mac_address,
        &DiscoveredDevice::firmware, &DiscoveredDevice::subnet_mask, &DiscoveredDevice::gateway,
        &DiscoveredDevice::http_port})
    fill((*same).*member, device.*member);
  if (!same->dhcp) same->dhcp = device.dhcp;
  if (!same->activated) same->activated = device.activated;
  for (const std::string& protocol : device.protocols)
    if (std::find(same->protocols.begin(), same->protocols.end(), protocol) == same->protocols.end())
      same->protocols.push_back(protocol);
}

}  // namespace cartvo
