#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

namespace cartvo::capture {

/// Tests whether a server accepts TCP connections at "HOST:PORT" by connecting and closing. Returns the
/// error's text; nothing if the connection succeeds. Takes at most `timeout`, plus the time to resolve a host
/// name. `interrupted` aborts it within 0.1 s; returns nothing then.
///
/// The kernel repeats a lost connection request after 1, 3 and 7 s. Short attempts instead reach a camera
/// that is available again seconds earlier.
std::optional<std::string> tcpConnectError(const std::string& host, std::chrono::milliseconds timeout,
                                           const std::atomic<bool>& interrupted);

}  // namespace cartvo::capture
