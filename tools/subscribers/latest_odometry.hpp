#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>

#include <cartvo/odometry_t.hpp>
#include <lcm/lcm-cpp.hpp>

namespace cartvo {

/// Subscriber to CARTVO_ODOMETRY that keeps only the newest message. If a subscriber is slow, LCM keeps the
/// old messages and drops the new ones; therefore each update drains the queue.
class LatestOdometry {
 public:
  explicit LatestOdometry(lcm::LCM& lcm) : lcm_(lcm) {
    lcm_.subscribe("CARTVO_ODOMETRY", &LatestOdometry::onMessage, this);
  }

  /// Waits up to `timeout_ms` for an odometry message, then handles all queued ones. Returns whether there
  /// was one. Messages of other channels, such as LCM's self-test at a program's start, do not count.
  bool update(int timeout_ms) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = Clock::now() + std::chrono::milliseconds(timeout_ms);
    const std::uint64_t before = received_;
    int left_ms = timeout_ms;
    while (received_ == before && lcm_.handleTimeout(left_ms) > 0) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
      left_ms = static_cast<int>(std::max<std::int64_t>(left.count(), 0));
    }
    while (received_ != before && lcm_.handleTimeout(0) > 0) {
    }
    return received_ != before;
  }

  /// The newest message; default-initialised before the first.
  const odometry_t& message() const { return message_; }

  /// Number of messages lost since the first one of this daemon run.
  std::int64_t lost() const { return lost_; }

  /// Whether a controller may use the message at `now_utime` (us since the Unix epoch): it is valid, not
  /// older than its time to live, and not further in the future than that. A future message would stay fresh
  /// after the clock is set back.
  bool isUsable(std::int64_t now_utime) const {
    const std::int64_t age = now_utime - message_.utime;
    return message_.status == odometry_t::VALID && age <= message_.time_to_live_us &&
           age >= -message_.time_to_live_us;
  }

 private:
  void onMessage(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                 const odometry_t* message) {
    const bool restarted = message->sequence <= message_.sequence;
    if (received_ > 0 && !restarted) lost_ += message->sequence - message_.sequence - 1;
    if (restarted) lost_ = 0;
    message_ = *message;
    ++received_;
  }

  lcm::LCM& lcm_;
  odometry_t message_{};
  std::uint64_t received_ = 0;
  std::int64_t lost_ = 0;
};

}  // namespace cartvo
