// Checks of an odometry message before it moves anything.

#include <algorithm>
#include <cmath>
#include <iterator>

#include <cartvo/client.hpp>

namespace cartvo::client {
namespace {

constexpr double kLargest = 1e12;  // of what has no limit of its own

/// Whether all values are finite and at most `limit` in magnitude. NaN fails the comparison.
template <typename Values>
bool allWithin(const Values& values, double limit) {
  return std::all_of(std::begin(values), std::end(values),
                     [limit](double value) { return std::abs(value) <= limit; });
}

/// Whether bounds are finite and not negative.
bool areBounds(const double (&bounds)[3]) {
  return allWithin(bounds, kLargest) &&
         std::all_of(std::begin(bounds), std::end(bounds), [](double bound) { return bound >= 0.0; });
}

/// Whether a 6x6 covariance is finite and has no negative variance.
bool isCovariance(const double (&covariance)[36]) {
  constexpr int kSide = 6;
  bool has_variances = allWithin(covariance, kLargest);
  for (int i = 0; i < kSide; ++i)
    has_variances = has_variances && covariance[i * kSide + i] >= 0.0;
  return has_variances;
}

}  // namespace

std::int64_t nowUtime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

const char* verdictText(OdometryVerdict verdict) {
  switch (verdict) {
    case OdometryVerdict::usable:
      return "usable";
    case OdometryVerdict::invalid:
      return "invalid";
    case OdometryVerdict::contradicted:
      return "valid, but with a reason against it";
    case OdometryVerdict::senseless:
      return "valid, but with senseless numbers";
    case OdometryVerdict::uncertain:
      return "valid, but a bound exceeds the controller's limit";
    case OdometryVerdict::corrupted:
      return "valid, but changed on its way";
    case OdometryVerdict::late:
      return "late";
    case OdometryVerdict::future:
      return "from the future";
  }
  return "unknown";
}

bool hasPossibleMotion(const odometry_t& message, const OdometryLimits& limits) {
  const double* q = message.orientation_world_body;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  constexpr double kTolerance = 1e-3;
  return allWithin(message.velocity_body, limits.speed) &&
         allWithin(message.angular_velocity_body, limits.turn_rate) &&
         allWithin(message.position_world_body, limits.distance) && std::abs(norm - 1.0) <= kTolerance &&
         isCovariance(message.twist_covariance_body) && isCovariance(message.pose_covariance_body) &&
         areBounds(message.velocity_bound) && areBounds(message.angular_rate_bound) &&
         areBounds(message.motion_bound) && areBounds(message.rotation_bound);
}

bool isCertainEnough(const odometry_t& message, const OdometryLimits& limits) {
  return allWithin(message.velocity_bound, limits.velocity_bound) &&
         allWithin(message.angular_rate_bound, limits.angular_rate_bound) &&
         allWithin(message.motion_bound, limits.motion_bound) &&
         allWithin(message.rotation_bound, limits.rotation_bound);
}

bool isConsistent(const odometry_t& message) {
  return message.status == odometry_t::VALID && (message.reasons & ~odometry_t::REASON_ZERO_VELOCITY) == 0 &&
         message.quality > 0;
}

std::int64_t ageUs(const odometry_t& message, std::int64_t now_utime) {
  constexpr std::int64_t kFarthest = std::int64_t{1} << 61;
  return std::clamp(now_utime, -kFarthest, kFarthest) - std::clamp(message.utime, -kFarthest, kFarthest);
}

OdometryVerdict judge(const odometry_t& message, std::int64_t now_utime, const OdometryLimits& limits) {
  if (message.status == odometry_t::INVALID) return OdometryVerdict::invalid;
  if (!isConsistent(message)) return OdometryVerdict::contradicted;
  const bool has_time_to_live =
      message.time_to_live_us > 0 && message.time_to_live_us <= limits.max_time_to_live_us;
  if (!has_time_to_live || !hasPossibleMotion(message, limits)) return OdometryVerdict::senseless;
  if (!isCertainEnough(message, limits)) return OdometryVerdict::uncertain;
  if (!isIntact(message)) return OdometryVerdict::corrupted;
  const std::int64_t age = ageUs(message, now_utime);
  if (age < -limits.max_future_us) return OdometryVerdict::future;
  return age <= std::min(message.time_to_live_us, limits.max_age_us) ? OdometryVerdict::usable
                                                                     : OdometryVerdict::late;
}

}  // namespace cartvo::client
