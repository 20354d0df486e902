#pragma once

#include <chrono>
#include <string>

namespace cartvo::daemon {

/// Notifications to systemd (sd_notify(3)); without systemd each call does nothing.
class ServiceManager {
 public:
  ServiceManager();

  /// Sends READY=1, once.
  void notifyReady();
  /// Sets the line that `systemctl status` shows.
  void setStatus(const std::string& text);
  /// Feeds the watchdog at most once in 2 s, or in a quarter of the watchdog period if that is shorter. Call
  /// it only while the work makes progress.
  void feedWatchdog();
  /// Has systemd restart the daemon now, as if the watchdog's time were over.
  void triggerWatchdog();
  /// Sends STOPPING=1.
  void notifyStopping();

 private:
  bool is_ready_ = false;
  std::chrono::microseconds feeding_period_ = std::chrono::seconds(2);
  std::chrono::steady_clock::time_point last_fed_;
};

}  // namespace cartvo::daemon
