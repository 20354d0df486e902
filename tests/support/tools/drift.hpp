#pragma once

#include "tools/trajectory/trajectory.hpp"

namespace cartvo::test {

/// Distance between the last poses if the first ones coincide, as a fraction of the true path. Both
/// trajectories have as many poses.
inline double driftFraction(const Trajectory& estimate, const Trajectory& truth) {
  const auto motion = [](const Trajectory& trajectory) {
    return trajectory.front().pose.inverse() * trajectory.back().pose;
  };
  return (motion(estimate).inverse() * motion(truth)).translation().norm() / pathLength(truth);
}

}  // namespace cartvo::test
