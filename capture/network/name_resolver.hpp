#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include <sys/socket.h>

namespace cartvo::capture {

/// An address of a server and its port, for connect().
struct ServerAddress {
  sockaddr_storage address{};
  socklen_t size = 0;

  /// The address without the port, such as "192.0.2.1" or "fe80::1%eth0".
  std::string text() const;
};

/// The addresses that a name has, or why there are none.
struct ResolvedName {
  std::vector<ServerAddress> addresses;  ///< in the resolver's order, IPv4 and IPv6, at most 8
  std::string error;                     ///< text for messages; empty: there are addresses
};

/// Resolves a host and a decimal port. Returns at the deadline, and within 0.1 s after an interruption, with
/// an error that names the host. The system's resolver blocks for tens of seconds where no name server
/// answers, so that it runs in a thread of its own, at most one for each host and port. A look-up that is not
/// finished goes on, and the next call for the same host and port gets its answer. Addresses are converted
/// without a thread.
ResolvedName resolveName(const std::string& host, const std::string& port,
                         std::chrono::steady_clock::time_point deadline,
                         const std::atomic<bool>& interrupted);

}  // namespace cartvo::capture
