#pragma once

#include <Eigen/Geometry>

#include "pipeline/pair_processor.hpp"

namespace cartvo::test {

constexpr int kEthernetFrame = 1400;  ///< bytes of a message that LCM sends unfragmented

/// Result of a pair that is valid: bounds below their default limits, the worst one 0.006 rad of 1.5 deg.
inline pipeline::PairResult validResult() {
  pipeline::PairResult result;
  result.left = {{1'000'000'500'000}, 1'000'020'000'000, 1'000'025'000'000, 7};
  result.right = {{1'000'003'500'000}, 1'000'021'000'000, 1'000'024'000'000, 9};
  result.estimate.valid = true;
  result.estimate.time_step = 0.05;
  result.estimate.reset_counter = 3;
  result.estimate.counts = {900, 800, 700, 600};
  result.motion.T_world_body.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  result.motion.T_world_body.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  result.motion.velocity = Eigen::Vector3d(4.0, 0.1, -0.2);
  result.motion.angular_velocity = Eigen::Vector3d(0.01, 0.02, 0.3);
  for (int i = 0; i < 36; ++i)
    result.motion.pose_covariance(i / 6, i % 6) = i;
  result.motion.twist_covariance = vo::Matrix6d::Identity();
  result.motion.acceleration = Eigen::Vector3d(1.0, 0.5, 0.0);
  result.motion.acceleration_covariance = 0.09 * Eigen::Matrix3d::Identity();
  const auto bounds = [](double x) { return Eigen::Vector3d(x, 2.0 * x, 3.0 * x); };
  result.level = {bounds(0.04), bounds(0.001), bounds(0.01), bounds(0.002)};
  result.worst = pipeline::worstBound(result.level, {});
  return result;
}

}  // namespace cartvo::test
