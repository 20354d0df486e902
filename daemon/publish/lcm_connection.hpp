#pragma once

#include <memory>
#include <string>

namespace lcm {
class LCM;
}

// Connection to LCM, with checks of its URL and multicast route.

namespace cartvo::daemon {

constexpr const char* kOdometryChannel = "CARTVO_ODOMETRY";
constexpr const char* kHealthChannel = "CARTVO_HEALTH";

/// Route of the multicast packets of an LCM URL.
struct MulticastRoute {
  std::string address;    ///< multicast group
  std::string interface;  ///< empty: no route
  bool loopback = false;
  int ttl = 0;  ///< hops; 0 stays on this host
};

/// Checks an LCM URL. Throws std::invalid_argument if `url` is not udpm://GROUP:PORT[?ttl=N...] with a
/// multicast GROUP.
void checkLcmUrl(const std::string& url);

/// GROUP:PORT of an LCM URL. Throws as checkLcmUrl.
std::string multicastGroup(const std::string& url);

/// Queries the kernel's routing table. Throws std::invalid_argument if `url` is not
/// udpm://GROUP:PORT[?ttl=N...].
MulticastRoute findMulticastRoute(const std::string& url);

/// Connects to LCM. Throws std::runtime_error if there is no multicast route; the message says how to add
/// one.
std::unique_ptr<lcm::LCM> connectLcm(const std::string& url);

/// Warning for the log if the route does not match the URL's time to live: LCM sends over the default route
/// without an error. Empty if the route fits.
std::string multicastWarning(const MulticastRoute& route);

}  // namespace cartvo::daemon
