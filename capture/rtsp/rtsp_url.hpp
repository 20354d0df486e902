#pragma once

#include <string>
#include <string_view>

// URLs of RTSP streams (RFC 2326, 3.2; RFC 3986; zones of link-local addresses: RFC 6874).

namespace cartvo::capture {

/// Parts of "rtsp://host[:port]/path". The scheme and the host are case-insensitive (RFC 3986, 6.2.2.1).
struct RtspUrl {
  std::string host;  ///< without the brackets of an IPv6 address, its zone as "fe80::1%eth0"; in lower case
                     ///< but for the zone
  std::string port;  ///< decimal; 554 if the URL has none
  std::string authority;  ///< "host[:port]" as written, for messages

  /// Whether both URLs lead to the same server. Zones are not compared: only this computer knows them.
  bool hasSameServer(const RtspUrl& other) const;
};

/// Throws std::invalid_argument, without repeating the URL, unless it is "rtsp://host[:port]/path" without
/// user, password or white space.
void checkRtspUrl(const std::string& url);

/// Splits a URL that checkRtspUrl accepts.
RtspUrl parseRtspUrl(const std::string& url);

/// The URL as the server gets it: without the zone of a link-local address, which has a meaning on this
/// computer only (RFC 6874, 4).
std::string urlForServer(const std::string& url);

/// The URL's "host[:port]".
std::string rtspHost(const std::string& url);

/// URL of a stream: the control attribute of a session description (RFC 2326, C.1.1) against its base. A
/// relative one is appended to the base, as cameras expect, also where the base has a query.
std::string controlUrl(std::string_view base, std::string_view control);

}  // namespace cartvo::capture
