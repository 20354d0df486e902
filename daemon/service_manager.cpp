// How the daemon tells systemd that it is ready, alive and about to end.

#include "daemon/service_manager.hpp"

#include <cstdlib>

#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

namespace cartvo {

ServiceManager::ServiceManager() {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) watchdog_period_ = std::chrono::microseconds(period_us);
}

void ServiceManager::ready() {
  if (is_ready_) return;
  is_ready_ = true;
  sd_notify(0, "READY=1");
}

void ServiceManager::status(const std::string& text) {
  sd_notify(0, ("STATUS=" + text).c_str());
}

void ServiceManager::feedWatchdog() {
  const auto now = std::chrono::steady_clock::now();
  if (watchdog_period_.count() == 0 || now - last_fed_ < watchdog_period_ / 4) return;
  last_fed_ = now;
  sd_notify(0, "WATCHDOG=1");
}

void ServiceManager::stopping() {
  sd_notify(0, "STOPPING=1\nSTATUS=stopping");
}

bool logsToJournal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || fstat(STDERR_FILENO, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == stream;
}

}  // namespace cartvo
