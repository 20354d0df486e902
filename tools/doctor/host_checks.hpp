#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/service/configuration.hpp"
#include "tools/doctor/finding_list.hpp"

// Checks of the computer: processors, memory, receive buffers, disk, time.

namespace cartvo::doctor {

/// Checks load and available memory. `proc`: folder of the kernel's files, /proc.
void checkComputer(const std::filesystem::path& proc, FindingList& findings);

/// Checks the kernel's limit of receive buffers.
void checkReceiveBuffers(const std::filesystem::path& proc, const daemon::Configuration& configuration,
                         FindingList& findings);

/// Checks the space for recordings, if recordings are configured.
void checkDisk(const daemon::Configuration& configuration, FindingList& findings);

/// State of the kernel's clock (adjtimex(2)).
struct KernelClock {
  bool is_synchronised = false;
  double max_error = 0.0;  ///< s
};

/// Nothing if the kernel does not say.
std::optional<KernelClock> readKernelClock();

/// Whether a program of this computer serves time to others (UDP port 123). `proc`: as above.
bool servesTime(const std::filesystem::path& proc);

/// Checks whether a program keeps the computer's time, or at least gives it to the cameras.
void checkKernelClock(const std::optional<KernelClock>& clock, bool serves_time, FindingList& findings);

/// Output of `chronyc -n -c clients`, at most 64 KiB, within two seconds; nothing if chronyd does not run
/// here or does not answer, which it does only to root.
std::optional<std::string> chronyClients();

/// Checks whether the camera at `host` is among the clients of chronyd. `clients`: as chronyClients().
void checkTimeClient(const std::string& host, std::string_view clients, FindingList& findings);

}  // namespace cartvo::doctor
