#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <system_error>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace cartvo {

/// Event that wakes threads that wait for file descriptors; stays set.
class WakeEvent {
 public:
  /// Throws std::system_error if the system has no descriptor left.
  WakeEvent() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  ~WakeEvent() { close(descriptor_); }
  WakeEvent(const WakeEvent&) = delete;
  WakeEvent& operator=(const WakeEvent&) = delete;

  void wake() noexcept { eventfd_write(descriptor_, 1); }

  /// Readable once the event is set.
  int descriptor() const { return descriptor_; }

  /// Waits for the event until an instant, at most a minute.
  void waitUntil(std::chrono::steady_clock::time_point instant) const {
    using std::chrono::milliseconds;
    const auto left = std::chrono::ceil<milliseconds>(instant - std::chrono::steady_clock::now()).count();
    if (left <= 0) return;
    pollfd waiting{descriptor_, POLLIN, 0};
    poll(&waiting, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000)));
  }

 private:
  int descriptor_;
};

}  // namespace cartvo
