#pragma once

#include <memory>
#include <string>

namespace lcm {
class LCM;
}

namespace cartvo {

constexpr const char* kOdometryChannel = "CARTVO_ODOMETRY";
constexpr const char* kHealthChannel = "CARTVO_HEALTH";

/// Where the kernel sends the multicast packets of an LCM URL.
struct MulticastRoute {
  std::string address;    ///< of the group
  std::string interface;  ///< empty: there is no route
  bool loopback = false;
  int ttl = 0;  ///< hops; 0 stays on this host
};

/// Throws std::invalid_argument if `url` is not udpm://GROUP:PORT[?ttl=N...] with a multicast GROUP.
void checkLcmUrl(const std::string& url);

/// Asks the kernel. `url`: udpm://GROUP:PORT[?ttl=N...]; throws std::invalid_argument if it is not one.
MulticastRoute findMulticastRoute(const std::string& url);

/// Connects to LCM. Throws std::runtime_error, saying how to add it, if there is no route for multicast.
std::unique_ptr<lcm::LCM> connectLcm(const std::string& url);

/// A sentence for the log if messages may not go where one expects, although they can be sent: LCM follows
/// the default route and says nothing. Empty if all is well.
std::string multicastWarning(const MulticastRoute& route);

}  // namespace cartvo
