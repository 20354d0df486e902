#pragma once

#include <cstdint>
#include <limits>

#include <cartvo/client.hpp>

namespace cartvo::test {

constexpr std::int64_t kMessageUtime = 1'000'000'000;  ///< default instant of `validMessage`, us
constexpr std::int64_t kTimeToLive_us = 250'000;       ///< of `validMessage`

/// The message with the check sum of its content.
inline odometry_t sealed(odometry_t message) {
  message.crc32 = client::contentCrc(message);
  return message;
}

/// A VALID message of a cart that drives ahead at 3 m/s, with bounds of half their limits; published 20 ms
/// after its exposure.
inline odometry_t validMessage(std::int64_t sequence = 1, std::int64_t utime = kMessageUtime) {
  odometry_t message{};
  message.sequence = sequence;
  message.utime = utime;
  message.publication_utime =
      utime > std::numeric_limits<std::int64_t>::max() - 20'000 ? utime : utime + 20'000;
  message.time_to_live_us = kTimeToLive_us;
  message.status = odometry_t::VALID;
  message.quality = 50;
  for (int axis = 0; axis < 3; ++axis) {
    message.velocity_bound[axis] = 0.15;
    message.angular_rate_bound[axis] = 0.026;
    message.motion_bound[axis] = 0.075;
    message.rotation_bound[axis] = 0.013;
  }
  message.orientation_world_body[0] = 1.0;
  message.velocity_body[0] = 3.0;
  return sealed(message);
}

/// As the daemon publishes it: no velocities.
inline odometry_t invalidMessage(std::int64_t sequence, std::int64_t utime, std::int32_t reasons) {
  odometry_t message = validMessage(sequence, utime);
  message.status = odometry_t::INVALID;
  message.reasons = reasons;
  message.quality = 0;
  for (double* values : {message.velocity_body, message.angular_velocity_body, message.velocity_bound,
                         message.angular_rate_bound, message.motion_bound, message.rotation_bound})
    values[0] = values[1] = values[2] = std::numeric_limits<double>::quiet_NaN();
  return sealed(message);
}

}  // namespace cartvo::test
