// Checks of LCM's network.
#include "tools/doctor/network/lcm_checks.hpp"

#include <stdexcept>

#include "daemon/publish/lcm_connection.hpp"

namespace cartvo::doctor {
namespace {

constexpr const char* kRouteAdvice =
    "systemctl enable --now cartvo-multicast, or for other computers ttl=1 in lcm.url and the route of their "
    "network";

/// False if there is no route.
bool checkRoute(const std::string& url, FindingList& findings) {
  const daemon::MulticastRoute route = daemon::findMulticastRoute(url);
  if (route.interface.empty()) {
    findings.add("multicast route", Verdict::broken,
                 {"no route for " + route.address, "a route for the multicast group", kRouteAdvice});
    return false;
  }
  const std::string warning = daemon::multicastWarning(route);
  findings.add("multicast route", okIf(warning.empty(), Verdict::look_at),
               {route.address + " through " + route.interface + (warning.empty() ? "" : ": " + warning),
                "through lo with ttl=0, through a network with ttl=1", kRouteAdvice});
  return true;
}

void checkReturn(const LcmObservation& seen, FindingList& findings) {
  if (!seen.problem.empty()) {
    findings.add("own message", Verdict::broken,
                 {seen.problem, "LCM connects", "correct lcm.url and the route"});
    return;
  }
  findings.add("own message", okIf(seen.is_returned, Verdict::broken),
               {seen.is_returned ? "received back" : "not received back", "received back",
                "permit UDP multicast in the firewall, and see that the interface of the route is up with "
                "multicast on (ip link)"});
}

}  // namespace

void checkLcm(const std::string& url, const LcmObservation& seen, FindingList& findings) {
  if (!checkRoute(url, findings)) return;
  checkReturn(seen, findings);
  findings.add(
      "publishers", okIf(!seen.has_two_publishers && !seen.has_foreign_messages, Verdict::broken),
      {seen.has_two_publishers     ? "two programs publish CARTVO_ODOMETRY"
       : seen.has_foreign_messages ? "a program of another release publishes: its messages cannot be decoded"
       : seen.health               ? "one cartvod"
                                   : "no cartvod",
       "one cartvod at most, of this release",
       "stop one of them or give it another lcm.url; install one release on all computers"});
}

}  // namespace cartvo::doctor
