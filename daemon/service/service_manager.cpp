// Notifies systemd of readiness, status, watchdog and stop.

#include "daemon/service/service_manager.hpp"

#include <algorithm>
#include <cstdlib>

#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

namespace cartvo::daemon {

ServiceManager::ServiceManager() {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) {
    feeding_period_ = std::min(feeding_period_, std::chrono::microseconds(period_us / 4));
  }
}

void ServiceManager::notifyReady() {
  if (is_ready_) return;
  is_ready_ = true;
  sd_notify(0, "READY=1");
}

void ServiceManager::setStatus(const std::string& text) {
  sd_notify(0, ("STATUS=" + text).c_str());
}

void ServiceManager::feedWatchdog() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_fed_ < feeding_period_) return;
  last_fed_ = now;
  // systemd arms the watchdog at READY=1. Until then extend the start time-out, too, so that cameras may be
  // absent for any time but a stalled stage is still detected; other managers look at the watchdog from the
  // start.
  sd_notify(0, is_ready_ ? "WATCHDOG=1" : "WATCHDOG=1\nEXTEND_TIMEOUT_USEC=30000000");
}

void ServiceManager::triggerWatchdog() {
  sd_notify(0, "WATCHDOG=trigger");
}

void ServiceManager::notifyStopping() {
  sd_notify(0, "STOPPING=1\nSTATUS=stopping");
}

}  // namespace cartvo::daemon
