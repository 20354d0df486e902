#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>

#include <cartvo/odometry_t.hpp>
#include <lcm/lcm-cpp.hpp>

#include "tools/subscribers/odometry_check.hpp"

namespace cartvo {

/// Subscriber to CARTVO_ODOMETRY that keeps only the newest message. If a subscriber is slow, LCM keeps the
/// old messages and drops the new ones; therefore each update drains the queue.
///
/// UDP can repeat and reorder messages. A message is newer than the kept one if its sequence is higher, or if
/// the daemon has restarted: a lower sequence that was published later. Others are ignored, unless nothing
/// newer came for `silence`: then the clock of the daemon's computer may have been set back meanwhile.
class LatestOdometry {
 public:
  using Clock = std::chrono::steady_clock;

  explicit LatestOdometry(lcm::LCM& lcm, std::chrono::milliseconds silence = std::chrono::seconds(1))
      : lcm_(lcm), silence_(silence) {
    lcm_.subscribe("CARTVO_ODOMETRY", &LatestOdometry::onData, this);
  }

  /// Waits up to `timeout_ms` for a newer odometry message, then handles all queued ones. Returns whether
  /// there was one. Messages of other channels, such as LCM's self-test at a program's start, do not count.
  bool update(int timeout_ms) {
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

  /// Number of messages ignored because they were older than the newest one, or repeated it.
  std::uint64_t ignored() const { return ignored_; }

  /// Number of messages that could not be decoded: the daemon is of a release with another odometry_t.
  std::uint64_t undecodable() const { return undecodable_; }

  /// Whether two programs publish odometry: within the last two seconds the sequence went back more than
  /// once. Their poses are not related, and either may be the wrong one.
  bool hasTwoPublishers() const {
    return second_restart_ != Clock::time_point{} && Clock::now() - second_restart_ < kRestartTime &&
           last_restart_ - second_restart_ < kRestartTime;
  }

  /// Whether a controller may use the message at `now_utime` (us since the Unix epoch), or why not.
  OdometryVerdict verdict(std::int64_t now_utime) const {
    return hasTwoPublishers() ? OdometryVerdict::contradicted : judge(message_, now_utime);
  }

  bool isUsable(std::int64_t now_utime) const { return verdict(now_utime) == OdometryVerdict::usable; }

 private:
  static constexpr std::chrono::seconds kRestartTime{2};  // a daemon does not restart twice in this time

  void onData(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    odometry_t message{};
    const auto bytes = static_cast<int>(buffer->data_size);
    if (message.decode(buffer->data, 0, bytes) != bytes) {
      ++undecodable_;
    } else if (received_ > 0 && !isNewer(message)) {
      ++ignored_;
    } else {
      keep(message);
    }
  }

  bool isNewer(const odometry_t& message) const {
    return message.sequence > message_.sequence || message.publication_utime > message_.publication_utime ||
           Clock::now() - last_reception_ > silence_;
  }

  void keep(const odometry_t& message) {
    const bool restarted = received_ > 0 && message.sequence <= message_.sequence;
    if (restarted) {
      second_restart_ = last_restart_;
      last_restart_ = Clock::now();
      lost_ = 0;
    } else if (received_ > 0 && message_.sequence >= 0) {  // then the difference does not overflow
      lost_ += message.sequence - message_.sequence - 1;
    }
    message_ = message;
    last_reception_ = Clock::now();
    ++received_;
  }

  lcm::LCM& lcm_;
  std::chrono::milliseconds silence_;
  odometry_t message_{};
  std::uint64_t received_ = 0, ignored_ = 0, undecodable_ = 0;
  std::int64_t lost_ = 0;
  Clock::time_point last_reception_, last_restart_, second_restart_;
};

}  // namespace cartvo
