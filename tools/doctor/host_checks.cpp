// Checks of the computer that runs cartvod.
#include "tools/doctor/host_checks.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/timex.h>

namespace cartvo::doctor {
namespace {

namespace fs = std::filesystem;

constexpr double kMegabyte = 1e6, kGigabyte = 1e9;

/// The first number of a file.
std::optional<double> firstNumber(const fs::path& file) {
  std::ifstream stream(file);
  double value = 0.0;
  if (!(stream >> value)) return std::nullopt;
  return value;
}

/// Memory that programs can use, bytes, of /proc/meminfo.
std::optional<double> availableMemory(const fs::path& file) {
  constexpr double kBytesPerUnit = 1024.0;
  std::ifstream stream(file);
  std::string name, unit;
  double value = 0.0;
  while (stream >> name >> value && std::getline(stream, unit)) {
    if (name == "MemAvailable:") return kBytesPerUnit * value;
  }
  return std::nullopt;
}

void addUnreadable(const char* subject, const fs::path& file, FindingList& findings) {
  findings.add(subject, Verdict::not_checked, {file.string() + " cannot be read"});
}

void checkLoad(const fs::path& proc, FindingList& findings) {
  const std::optional<double> load = firstNumber(proc / "loadavg");
  if (!load) return addUnreadable("load", proc / "loadavg", findings);
  const unsigned processors = std::thread::hardware_concurrency();
  findings.add("load", okIf(*load <= processors, Verdict::look_at),
               {fmt::format("{:.2f} running programs on {} processors, mean of a minute", *load, processors),
                "not more programs than processors", "see top, and stop other programs"});
}

void checkMemory(const fs::path& proc, FindingList& findings) {
  constexpr double kNeeded = 300e6;  // bytes; cartvod takes 100 to 200 MB
  const std::optional<double> available = availableMemory(proc / "meminfo");
  if (!available) return addUnreadable("memory", proc / "meminfo", findings);
  findings.add("memory", okIf(*available >= kNeeded, Verdict::look_at),
               {fmt::format("{:.0f} MB available", *available / kMegabyte),
                fmt::format("{:.0f} MB or more", kNeeded / kMegabyte), "see top, and stop other programs"});
}

/// The folder, or the closest one above it that exists.
fs::path existingFolder(fs::path folder) {
  std::error_code error;
  while (!fs::exists(folder, error) && folder.has_relative_path())
    folder = folder.parent_path();
  return folder;
}

}  // namespace

void checkComputer(const fs::path& proc, FindingList& findings) {
  checkLoad(proc, findings);
  checkMemory(proc, findings);
}

void checkReceiveBuffers(const fs::path& proc, const daemon::Configuration& configuration,
                         FindingList& findings) {
  constexpr double kAskedFor = 2.0 * 1024 * 1024;  // bytes, by cartvod for each camera over UDP
  const fs::path file = proc / "sys/net/core/rmem_max";
  const std::optional<double> largest = firstNumber(file);
  if (!largest) return addUnreadable("receive buffers", file, findings);
  const bool is_udp = configuration.transport == capture::RtspTransport::udp;
  findings.add("receive buffers", okIf(!is_udp || *largest >= kAskedFor, Verdict::look_at),
               {fmt::format("at most {:.0f} bytes (net.core.rmem_max)", *largest),
                is_udp ? fmt::format("{:.0f} bytes or more, with cameras.transport: udp", kAskedFor)
                       : "any, with cameras.transport: tcp",
                "install 60-cartvo-buffers.conf (/usr/share/cartvo/network), then sysctl --system"});
}

void checkDisk(const daemon::Configuration& configuration, FindingList& findings) {
  const fs::path& folder = configuration.recording_directory;
  if (folder.empty()) {
    findings.add("disk", Verdict::ok, {"no recordings are configured"});
    return;
  }
  std::error_code error;
  const fs::space_info space = fs::space(existingFolder(folder), error);
  if (error) {
    findings.add("disk", Verdict::broken,
                 {folder.string() + ": " + error.message(), "a folder for recordings",
                  "correct recording.directory, or mount the disk"});
    return;
  }
  const auto available = static_cast<double>(space.available);
  const auto keep_free = static_cast<double>(configuration.recording_quota.keep_free_bytes);
  findings.add("disk", okIf(available > keep_free, Verdict::look_at),
               {fmt::format("{:.1f} GB free for {}", available / kGigabyte, folder.string()),
                fmt::format("more than recording.keep_free, {:.1f} GB", keep_free / kGigabyte),
                "make room, or lower recording.maximum_size: cartvod deletes its old recordings, and stops "
                "recording if there are none"});
}

std::optional<KernelClock> readKernelClock() {
  constexpr double kMicrosecond = 1e-6;
  timex time{};
  const int state = ::adjtimex(&time);
  if (state < 0) return std::nullopt;
  return KernelClock{state != TIME_ERROR && (time.status & STA_UNSYNC) == 0,
                     kMicrosecond * static_cast<double>(time.maxerror)};
}

bool servesTime(const fs::path& proc) {
  constexpr const char* kNtpPort = ":007B";  // 123
  for (const char* name : {"net/udp", "net/udp6"}) {
    std::ifstream stream(proc / name);
    std::string number, local, rest;
    while (stream >> number >> local && std::getline(stream, rest)) {
      if (local.ends_with(kNtpPort)) return true;
    }
  }
  return false;
}

void checkKernelClock(const std::optional<KernelClock>& clock, bool serves_time, FindingList& findings) {
  if (!clock) {
    findings.add("time", Verdict::not_checked, {"the kernel does not say whether its clock is kept"});
    return;
  }
  const std::string kept =
      clock->is_synchronised
          ? fmt::format("kept by a time service, error at most {:.0f} ms", 1e3 * clock->max_error)
          : "kept by no time source";
  findings.add("time", okIf(clock->is_synchronised || serves_time, Verdict::look_at),
               {"this computer's clock is " + kept +
                    (serves_time ? "; this computer serves its time to others"
                                 : "; this computer does not serve its time to others"),
                "a clock that is kept, or that the cameras follow",
                "apt install chrony, with the example file cartvo-cameras.conf (/usr/share/cartvo/network)"});
}

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
