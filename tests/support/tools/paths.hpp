#pragma once

#include <cmath>
#include <cstdint>

#include "tools/trajectory/trajectory.hpp"

// Simple paths with poses at 10 Hz.

namespace cartvo::test {

inline constexpr std::int64_t kPeriod = 100'000'000;  // ns

inline StampedPose poseAt(int index, const Eigen::Vector3d& position, double yaw) {
  StampedPose stamped;
  stamped.time_ns = index * kPeriod;
  stamped.pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  stamped.pose.translation() = position;
  return stamped;
}

/// Straight path along x, `step` metres between poses.
inline Trajectory straight(int poses, double step) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i)
    trajectory.push_back(poseAt(i, {i * step, 0.0, 0.0}, 0.0));
  return trajectory;
}

/// Circular path at constant speed, heading along it.
inline Trajectory circle(int poses, double radius, double step) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    const double angle = i * step / radius;
    trajectory.push_back(poseAt(i, {radius * std::sin(angle), radius * (1.0 - std::cos(angle)), 0.0}, angle));
  }
  return trajectory;
}

inline Trajectory scaled(Trajectory trajectory, double scale) {
  for (StampedPose& stamped : trajectory)
    stamped.pose.translation() *= scale;
  return trajectory;
}

/// A drive on a winding road, at 10 Hz, whose speed changes; `start`: s, of the first pose on the road.
inline Trajectory winding(int poses, double start) {
  Trajectory trajectory;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int i = 0; i < poses; ++i) {
    const double at = start + 0.1 * i, yaw = 0.5 * std::sin(at / 7.0) + 0.3 * std::sin(at / 3.1);
    trajectory.push_back(poseAt(i, position, yaw));
    position += 0.1 * (4.0 + std::sin(at / 5.0)) * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  }
  return trajectory;
}

inline Trajectory delayed(Trajectory trajectory, double delay) {
  for (StampedPose& stamped : trajectory)
    stamped.time_ns += std::llround(1e9 * delay);
  return trajectory;
}

}  // namespace cartvo::test
