#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

namespace cartvo {

/// Asks whether anybody listens at "HOST:PORT" by connecting and hanging up. Returns why not, in words;
/// nothing if somebody does. Takes `patience` at most (a host's name must be resolved beside it) and heeds
/// `interrupted` within 0.1 s, then returning nothing.
///
/// The kernel repeats a lost request to connect after 1, 3, 7 s: whoever waits for that meets a camera that
/// has come back seconds later than needs be.
std::optional<std::string> whyUnreachable(const std::string& host, std::chrono::milliseconds patience,
                                          const std::atomic<bool>& interrupted);

}  // namespace cartvo
