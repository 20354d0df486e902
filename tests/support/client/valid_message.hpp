#pragma once

#include <cstdint>
#include <limits>

#include <cartvo/odometry_t.hpp>

namespace cartvo::test {

constexpr std::int64_t kMessageUtime = 1'000'000'000;  ///< default instant of `validMessage`, us
constexpr std::int64_t kTimeToLive_us = 250'000;       ///< of `validMessage`

/// A VALID message of a cart that drives ahead at 3 m/s; published 20 ms after its exposure.
inline odometry_t validMessage(std::int64_t sequence = 1, std::int64_t utime = kMessageUtime) {
  odometry_t message{};
  message.sequence = sequence;
  message.utime = utime;
  message.publication_utime =
      utime > std::numeric_limits<std::int64_t>::max() - 20'000 ? utime : utime + 20'000;
  message.time_to_live_us = kTimeToLive_us;
  message.status = odometry_t::VALID;
  message.orientation_world_body[0] = 1.0;
  message.velocity_body[0] = 3.0;
  return message;
}

/// As the daemon publishes it: no velocities.
inline odometry_t invalidMessage(std::int64_t sequence, std::int64_t utime, std::int32_t reasons) {
  odometry_t message = validMessage(sequence, utime);
  message.status = odometry_t::INVALID;
  message.reasons = reasons;
  for (double* values : {message.velocity_body, message.angular_velocity_body})
    values[0] = values[1] = values[2] = std::numeric_limits<double>::quiet_NaN();
  return message;
}

}  // namespace cartvo::test
