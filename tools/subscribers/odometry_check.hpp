#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include <cartvo/odometry_t.hpp>

// Checks of an odometry message before it moves anything. They depend on the message type only.

namespace cartvo {

/// Limits of what a controller accepts. Wider than those of cartvod (50 m/s, 4 rad/s), so that only a wrong
/// message exceeds them.
struct OdometryLimits {
  double speed = 100.0;                           ///< m/s, each axis
  double turn_rate = 10.0;                        ///< rad/s, each axis
  double distance = 1e7;                          ///< m, each coordinate of the position
  std::int64_t max_time_to_live_us = 10'000'000;  ///< the most that cartvod can be configured to
  std::int64_t max_age_us = 1'000'000;            ///< the controller's own, whatever the time to live
  std::int64_t max_future_us = 10'000;            ///< difference between the clocks of two computers
};

/// Why a message cannot be used; the first that applies.
enum class OdometryVerdict : std::uint8_t {
  usable,
  invalid,       ///< the daemon says so
  contradicted,  ///< VALID, but with a reason other than standstill, or another status than the two defined
  senseless,     ///< a number that is not finite, not possible, or negative where it cannot be
  late,          ///< older than its time to live or than the controller accepts
  future,        ///< exposed after now: a clock is wrong
};

constexpr const char* verdictText(OdometryVerdict verdict) {
  switch (verdict) {
    case OdometryVerdict::usable:
      return "usable";
    case OdometryVerdict::invalid:
      return "invalid";
    case OdometryVerdict::contradicted:
      return "valid, but with a reason against it";
    case OdometryVerdict::senseless:
      return "valid, but with senseless numbers";
    case OdometryVerdict::late:
      return "late";
    case OdometryVerdict::future:
      return "from the future";
  }
  return "unknown";
}

/// Whether all values are finite and at most `limit` in magnitude. NaN fails the comparison.
template <typename Values>
bool allWithin(const Values& values, double limit) {
  return std::all_of(std::begin(values), std::end(values),
                     [limit](double value) { return std::abs(value) <= limit; });
}

/// Whether a 6x6 covariance is finite and has no negative variance.
inline bool isCovariance(const double (&covariance)[36]) {
  constexpr double kLargest = 1e12;
  constexpr int kSide = 6;
  bool has_variances = allWithin(covariance, kLargest);
  for (int i = 0; i < kSide; ++i)
    has_variances = has_variances && covariance[i * kSide + i] >= 0.0;
  return has_variances;
}

/// Whether pose, velocities and covariances are possible ones.
inline bool hasPossibleMotion(const odometry_t& message, const OdometryLimits& limits = {}) {
  const double* q = message.orientation_world_body;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  constexpr double kTolerance = 1e-3;
  return allWithin(message.velocity_body, limits.speed) &&
         allWithin(message.angular_velocity_body, limits.turn_rate) &&
         allWithin(message.position_world_body, limits.distance) && std::abs(norm - 1.0) <= kTolerance &&
         isCovariance(message.twist_covariance_body) && isCovariance(message.pose_covariance_body);
}

/// Whether the message says VALID, and nothing in it speaks against that.
inline bool isConsistent(const odometry_t& message) {
  return message.status == odometry_t::VALID && (message.reasons & ~odometry_t::REASON_ZERO_VELOCITY) == 0;
}

/// Age of the message at `now_utime`, us; negative: from the future. The extremes of int64 are limited, so
/// that no instant makes it overflow.
inline std::int64_t ageUs(const odometry_t& message, std::int64_t now_utime) {
  constexpr std::int64_t kLargest = std::int64_t{1} << 61;
  return std::clamp(now_utime, -kLargest, kLargest) - std::clamp(message.utime, -kLargest, kLargest);
}

/// Whether a controller may use the message at `now_utime` (us since the Unix epoch), or why not.
inline OdometryVerdict judge(const odometry_t& message, std::int64_t now_utime,
                             const OdometryLimits& limits = {}) {
  if (message.status == odometry_t::INVALID) return OdometryVerdict::invalid;
  if (!isConsistent(message)) return OdometryVerdict::contradicted;
  const bool has_time_to_live =
      message.time_to_live_us > 0 && message.time_to_live_us <= limits.max_time_to_live_us;
  if (!has_time_to_live || !hasPossibleMotion(message, limits)) return OdometryVerdict::senseless;
  const std::int64_t age = ageUs(message, now_utime);
  if (age < -limits.max_future_us) return OdometryVerdict::future;
  return age <= std::min(message.time_to_live_us, limits.max_age_us) ? OdometryVerdict::usable
                                                                     : OdometryVerdict::late;
}

}  // namespace cartvo
