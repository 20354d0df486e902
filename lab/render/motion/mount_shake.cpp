// Turns the cameras' mount by two sines of time, in pitch and in roll.
#include "lab/render/motion/mount_shake.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cartvo::world {

MountShake::MountShake(const WorldSettings& settings, const Eigen::Vector3d& mount)
    : shake_(settings.shake), start_(settings.lead_in_seconds), mount_(mount) {}

Eigen::Isometry3d MountShake::T_body_shaken(double seconds) const {
  constexpr double kFadeIn = 1.0;     // s
  constexpr double kRollShare = 0.6;  // of the amplitude of pitch
  constexpr double kRollPhase = 1.3;  // rad, ahead of pitch
  Eigen::Isometry3d shaken = Eigen::Isometry3d::Identity();
  if (shake_.amplitude == 0.0 || seconds <= start_) return shaken;
  const double t = std::min((seconds - start_) / kFadeIn, 1.0);
  const double fade = t * t * t * (t * (6.0 * t - 15.0) + 10.0);  // zero slope and curvature at both ends
  const double phase = 2.0 * std::numbers::pi * shake_.frequency * (seconds - start_);
  const double pitch = fade * shake_.amplitude * std::sin(phase);
  const double roll = fade * kRollShare * shake_.amplitude * std::sin(phase + kRollPhase);
  const Eigen::Quaterniond turn =
      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
  return Eigen::Translation3d(mount_) * turn * Eigen::Translation3d(-mount_);
}

}  // namespace cartvo::world
