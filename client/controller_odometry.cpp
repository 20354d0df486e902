// Input of a control loop: extrapolated motion while a message lives, then a ramp to the safe command.

#include <algorithm>
#include <cmath>
#include <limits>

#include <cartvo/client.hpp>

namespace cartvo::client {
namespace {

/// Longest time that one cycle raises the authority by, so that a controller that stalled does not jump.
constexpr std::chrono::milliseconds kLongestCycle{100};

/// Reasons of an INVALID message that put the messages before it in question too.
constexpr std::int32_t kReasonsAgainstThePast =
    int{odometry_t::REASON_REPEATED_PICTURE} | int{odometry_t::REASON_WRONG_STEREO_GEOMETRY};

bool speaksAgainstThePast(const odometry_t& message) {
  return message.status != odometry_t::VALID && (message.reasons & kReasonsAgainstThePast) != 0;
}

/// The pose of the motion, without anything that could be taken for a measurement.
Motion withoutMeasurement(Motion motion) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  motion.velocity.fill(kUnknown);
  motion.angular_velocity.fill(kUnknown);
  motion.pose_covariance.fill(kUnknown);
  motion.twist_covariance.fill(kUnknown);
  return motion;
}

/// Share of a ramp that passes in `time`; 1 for a ramp of no length.
double shareOf(SteadyClock::duration time, std::chrono::milliseconds ramp) {
  if (ramp.count() <= 0) return 1.0;
  return std::chrono::duration<double>(time) / std::chrono::duration<double>(ramp);
}

}  // namespace

const char* stateText(InputState state) {
  switch (state) {
    case InputState::waiting:
      return "waiting";
    case InputState::measured:
      return "measured";
    case InputState::ramping:
      return "ramping";
    case InputState::safe:
      return "safe";
  }
  return "unknown";
}

double ControllerInput::command(double wanted, double safe) const {
  if (!(authority > 0.0) || !std::isfinite(wanted)) return safe;
  return authority < 1.0 ? safe + authority * (wanted - safe) : wanted;
}

bool ControllerOdometry::add(const odometry_t& message, std::int64_t now_utime,
                             SteadyClock::time_point reception) {
  if (!isIntact(message)) {
    ++corrupted_;
    return false;
  }
  if (!newest_.add(message, reception)) return false;
  if (speaksAgainstThePast(message)) has_usable_ = false;
  if (judge(message, now_utime, settings_.limits) != OdometryVerdict::usable) return true;
  // A picture that was exposed before the one in use is of no use, even if its message came later.
  if (canUse(now_utime, reception) && message.utime < usable_.utime) return true;
  usable_ = message;
  usable_epoch_ = newest_.epoch();
  has_usable_ = true;
  return true;
}

bool ControllerOdometry::canUse(std::int64_t now_utime, SteadyClock::time_point now) const {
  return has_usable_ && !newest_.hasTwoPublishers(now) &&
         judge(usable_, now_utime, settings_.limits) == OdometryVerdict::usable;
}

void ControllerOdometry::moveAuthority(bool usable, SteadyClock::time_point now) {
  const bool is_first = last_input_ == SteadyClock::time_point{};
  const SteadyClock::duration cycle = is_first ? SteadyClock::duration::zero() : now - last_input_;
  last_input_ = now;
  if (usable) {
    const SteadyClock::duration longest = kLongestCycle;
    authority_ = std::min(1.0, authority_ + shareOf(std::min(cycle, longest), settings_.ramp_up));
  } else {
    authority_ = std::max(0.0, authority_ - shareOf(cycle, settings_.ramp_down));
  }
}

ControllerInput ControllerOdometry::input(std::int64_t now_utime, SteadyClock::time_point now) {
  const bool usable = canUse(now_utime, now);
  moveAuthority(usable, now);
  if (usable) {
    motion_ = extrapolate(usable_, now_utime, settings_.noise);
    motion_epoch_ = usable_epoch_;
    was_measured_ = true;
  }

  ControllerInput input;
  input.authority = authority_;
  input.epoch = motion_epoch_;
  input.age_us = was_measured_ ? ageUs(usable_, now_utime) : 0;
  input.verdict = judge(newest_.message(), now_utime, settings_.limits);
  input.two_publishers = newest_.hasTwoPublishers(now);
  if (usable) {
    input.state = InputState::measured;
  } else if (authority_ > 0.0) {
    input.state = InputState::ramping;
  } else {
    input.state = was_measured_ ? InputState::safe : InputState::waiting;
  }
  const bool has_motion = usable || authority_ > 0.0;
  input.motion = has_motion ? motion_ : withoutMeasurement(motion_);
  return input;
}

}  // namespace cartvo::client
