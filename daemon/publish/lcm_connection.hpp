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

/// Queries the kernel's routing table. Throws std::invalid_argument if `url` is not one of parseLcmUrl(),
/// std::system_error if the table cannot be queried, which tells nothing of the route.
MulticastRoute findMulticastRoute(const std::string& url);

/// As above. Throws std::runtime_error if there is no multicast route; the message says how to add one.
MulticastRoute requireMulticastRoute(const std::string& url);

/// Connects to LCM to receive. Throws as requireMulticastRoute().
std::unique_ptr<lcm::LCM> connectLcm(const std::string& url);

/// Warning for the log if the route does not match the URL's time to live, or is absent. Empty if the route
/// fits.
std::string multicastWarning(const MulticastRoute& route);

}  // namespace cartvo::daemon
