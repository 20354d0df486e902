// URLs of RTSP streams.

#include "capture/rtsp/rtsp_url.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "common/ascii_text.hpp"

namespace cartvo::capture {
namespace {

constexpr std::string_view kScheme = "rtsp://";
constexpr std::string_view kDefaultPort = "554";  // RFC 2326, 3.2

bool hasScheme(std::string_view url, std::string_view scheme) {
  return url.size() >= scheme.size() && lowerCase(url.substr(0, scheme.size())) == scheme;
}

std::string_view withoutZone(std::string_view host) {
  return host.substr(0, host.find('%'));
}

/// The host in lower case, with a zone as RFC 6874 writes it ("fe80::1%25eth0") or with a plain "%". Names of
/// interfaces keep their case.
std::string normalisedHost(std::string_view host) {
  constexpr std::string_view kEscapedPercent = "%25";
  const std::string_view address = withoutZone(host);
  std::string_view zone = host.substr(address.size());
  if (zone.empty()) return lowerCase(address);
  const bool is_escaped = zone.size() > kEscapedPercent.size() && zone.starts_with(kEscapedPercent);
  zone.remove_prefix(is_escaped ? kEscapedPercent.size() : 1);
  return lowerCase(address).append(1, '%').append(zone);
}

bool isPort(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }) &&
         std::stoi(std::string(text)) >= 1 && std::stoi(std::string(text)) <= 65535;
}

}  // namespace

void checkRtspUrl(const std::string& url) {
  if (hasScheme(url, "rtsps://")) {
    throw std::invalid_argument(
        "RTSP over TLS (rtsps://) is not supported; switch on plain RTSP in the camera and use rtsp://");
  }
  if (!hasScheme(url, kScheme)) {
    throw std::invalid_argument(
        "a camera's URL must begin with rtsp://, as in rtsp://192.168.1.64:554/Streaming/"
        "Channels/101");
  }
  for (const char c : url) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0 ||
        std::iscntrl(static_cast<unsigned char>(c)) != 0) {
      throw std::invalid_argument("a camera's URL must not contain white space");
    }
  }
  const std::string host = rtspHost(url);
  if (host.find('@') != std::string::npos) {
    throw std::invalid_argument(
        "a camera's URL must not contain a user or password (the part before '@'), because URLs are logged; "
        "give them as the camera's credentials");
  }
  const RtspUrl parts = parseRtspUrl(url);
  if (parts.host.empty()) throw std::invalid_argument("a camera's URL must contain a host after rtsp://");
  if (host.front() != '[' && std::count(host.begin(), host.end(), ':') > 1) {
    throw std::invalid_argument(
        "a camera's URL must have its IPv6 address in brackets, as in rtsp://[fe80::64%25eth1]:554/1");
  }
  if (!isPort(parts.port))
    throw std::invalid_argument("a camera's URL must have a port between 1 and 65535 after the host's colon");
}

RtspUrl parseRtspUrl(const std::string& url) {
  RtspUrl parts;
  parts.authority = rtspHost(url);
  const std::string& text = parts.authority;
  const std::size_t bracket = text.find(']');
  const std::size_t colon = text.find(':', bracket == std::string::npos ? 0 : bracket);
  parts.port = colon == std::string::npos ? std::string(kDefaultPort) : text.substr(colon + 1);
  parts.host =
      normalisedHost(bracket != std::string::npos && text.front() == '[' ? text.substr(1, bracket - 1)
                                                                         : text.substr(0, colon));
  return parts;
}

bool RtspUrl::hasSameServer(const RtspUrl& other) const {
  return withoutZone(host) == withoutZone(other.host) && port == other.port;
}

std::string urlForServer(const std::string& url) {
  const std::string authority = rtspHost(url);
  const std::size_t zone = authority.find('%');
  const std::size_t bracket = authority.find(']');
  if (zone == std::string::npos || bracket == std::string::npos || zone > bracket) return url;
  return std::string(url).erase(url.find(authority, kScheme.size()) + zone, bracket - zone);
}

std::string rtspHost(const std::string& url) {
  const std::size_t begin = std::min(url.size(), kScheme.size());
  return url.substr(begin, url.find_first_of("/?#", begin) - begin);
}

std::string controlUrl(std::string_view base, std::string_view control) {
  if (control.empty() || control == "*") return std::string(base);
  if (hasScheme(control, kScheme)) return std::string(control);
  std::string url(base);
  if (url.empty() || url.back() != '/') url += '/';
  if (control.front() == '/') control.remove_prefix(1);
  return url.append(control);
}

}  // namespace cartvo::capture
