#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>

#include <cartvo/odometry_t.hpp>
#include <lcm/lcm-cpp.hpp>

namespace cartvo {

/// What a controller wants of CARTVO_ODOMETRY: the newest message, nothing older. LCM keeps the *old*
/// messages when a subscriber is slow and drops the new ones, so each update drains the queue.
class LatestOdometry {
 public:
  explicit LatestOdometry(lcm::LCM& lcm) : lcm_(lcm) {
    lcm_.subscribe("CARTVO_ODOMETRY", &LatestOdometry::onMessage, this);
  }

  /// Waits up to `timeout_ms` for a message, then takes all that wait. False if there was none: what LCM
  /// handles may be of another channel, such as the self-test of a program that starts.
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

  const odometry_t& message() const { return message_; }

  /// Messages of this daemon run that never arrived.
  std::int64_t lost() const { return lost_; }

  /// Whether the message may be acted on at `now_utime` (us since the Unix epoch): valid, not too old, and
  /// not from the future, where a clock that was set back would make it last.
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
