#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>

namespace cartvo {

/// Queue from one thread to one other; neither ever waits, and nothing is allocated. A value that finds the
/// queue full is lost.
template <typename Value, std::size_t capacity>
class HandoverQueue {
 public:
  /// Called by one thread only. Returns false if the queue is full.
  bool push(const Value& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == capacity) return false;
    values_[end % capacity] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  /// Called by one other thread only.
  std::optional<Value> pop() {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return std::nullopt;
    const Value value = values_[begin % capacity];
    begin_.store(begin + 1, std::memory_order_release);
    return value;
  }

 private:
  std::array<Value, capacity> values_{};
  std::atomic<std::size_t> begin_{0}, end_{0};  ///< count all values; the difference is in the queue
};

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
