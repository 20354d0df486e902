#pragma once

#include <atomic>
#include <memory>

namespace cartvo {

/// Hands the newest value from one thread to another; neither ever waits. A value that was not taken is
/// replaced.
template <typename Value>
class Mailbox {
 public:
  Mailbox() = default;
  ~Mailbox() { take(); }
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  /// Returns the value that was not taken, for its memory; nullptr: none.
  std::unique_ptr<Value> put(std::unique_ptr<Value> value) {
    return std::unique_ptr<Value>(slot_.exchange(value.release(), std::memory_order_acq_rel));
  }
  /// Returns nullptr if there is none.
  std::unique_ptr<Value> take() {
    return std::unique_ptr<Value>(slot_.exchange(nullptr, std::memory_order_acq_rel));
  }

 private:
  std::atomic<Value*> slot_{nullptr};
};

}  // namespace cartvo
