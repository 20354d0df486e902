#pragma once

#include <chrono>
#include <string>

namespace cartvo {

/// The talk with systemd (sd_notify(3)); without systemd each call does nothing.
class ServiceManager {
 public:
  ServiceManager();

  /// READY=1, once.
  void ready();
  /// The line that `systemctl status` shows.
  void status(const std::string& text);
  /// Keeps systemd from killing the service; at most twice in each watchdog period. Call it only when work
  /// goes on.
  void feedWatchdog();
  void stopping();

 private:
  bool is_ready_ = false;
  std::chrono::microseconds feeding_period_ = std::chrono::seconds(2);
  std::chrono::steady_clock::time_point last_fed_;
};

/// Whether standard error goes to the journal, which stamps each line itself (systemd.exec(5),
/// $JOURNAL_STREAM).
bool logsToJournal();

}  // namespace cartvo
