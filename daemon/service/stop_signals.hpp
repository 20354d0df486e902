#pragma once

#include <chrono>
#include <csignal>
#include <ctime>
#include <optional>

namespace cartvo::daemon {

/// Waits for SIGTERM and SIGINT without a signal handler. Both are blocked from construction on, also in
/// threads started later.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }

  /// Returns the signal that arrived within `time`, or nothing.
  std::optional<int> wait(std::chrono::nanoseconds time) const {
    constexpr std::chrono::nanoseconds::rep kPerSecond = 1'000'000'000;
    const timespec timeout{static_cast<std::time_t>(time.count() / kPerSecond),
                           static_cast<long>(time.count() % kPerSecond)};
    const int signal = sigtimedwait(&signals_, nullptr, &timeout);
    return signal > 0 ? std::optional<int>(signal) : std::nullopt;
  }

 private:
  sigset_t signals_{};
};

}  // namespace cartvo::daemon
