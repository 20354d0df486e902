#pragma once

#include <chrono>
#include <csignal>
#include <ctime>
#include <optional>
#include <vector>

namespace cartvo::daemon {

/// Waits for signals, such as SIGTERM and SIGINT, without a signal handler. They are blocked from
/// construction on, also in threads started later.
class AwaitedSignals {
 public:
  explicit AwaitedSignals(const std::vector<int>& signals) {
    sigemptyset(&signals_);
    for (const int signal : signals)
      sigaddset(&signals_, signal);
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
