// Which cameras take the time from this computer.
#include "tools/doctor/time_clients.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace cartvo::doctor {
namespace {

constexpr std::size_t kMaxBytes = 65536;

/// The number of time requests in a client's line "ADDRESS,REQUESTS,...".
std::string requestsOf(std::string_view line) {
  line.remove_prefix(line.find(',') + 1);
  return std::string(line.substr(0, line.find(',')));
}

}  // namespace

std::optional<std::string> chronyClients() {
  std::FILE* pipe = ::popen("timeout 2 chronyc -n -c clients 2>/dev/null", "re");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  std::array<char, 4096> part{};
  for (std::size_t count = 0;
       text.size() < kMaxBytes && (count = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
    text.append(part.data(), count);
  const bool has_answered = ::pclose(pipe) == 0;
  return has_answered ? std::optional(text) : std::nullopt;
}

void checkTimeClient(const std::string& host, std::string_view clients, FindingList& findings) {
  constexpr const char* kExpected = "the camera asks this computer for the time";
  while (!clients.empty()) {
    const std::string_view line = clients.substr(0, clients.find('\n'));
    clients.remove_prefix(std::min(clients.size(), line.size() + 1));
    if (!line.starts_with(host + ",")) continue;
    const std::string requests = requestsOf(line);
    findings.add("time client", okIf(requests != "0", Verdict::look_at),
                 {host + " has asked this computer for the time, requests: " + requests, kExpected,
                  "set the camera to NTP with the address of its port as the server "
                  "(/usr/share/doc/cartvo/network.md)"});
    return;
  }
  findings.add("time client", Verdict::look_at,
               {host + " has not asked this computer for the time", kExpected,
                "set the camera to NTP with the address of its port as the server "
                "(/usr/share/doc/cartvo/network.md); nothing "
                "if another server of this network gives it the time"});
}

}  // namespace cartvo::doctor
