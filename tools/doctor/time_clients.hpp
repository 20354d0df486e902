#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tools/doctor/finding_list.hpp"

// Which cameras take the time from this computer.

namespace cartvo::doctor {

/// Output of `chronyc -n -c clients`, at most 64 KiB, within two seconds; nothing if chronyd does not run
/// here or does not answer, which it does only to root.
std::optional<std::string> chronyClients();

/// Checks whether the camera at `host` is among the clients of chronyd. `clients`: as chronyClients().
void checkTimeClient(const std::string& host, std::string_view clients, FindingList& findings);

}  // namespace cartvo::doctor
