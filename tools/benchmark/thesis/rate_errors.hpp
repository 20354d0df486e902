#pragma once

#include <cstddef>
#include <vector>

#include "tools/benchmark/sequence.hpp"
#include "tools/replay/replay.hpp"

namespace cartvo::benchmark {

/// RMSE of velocity and angular rates in body axes over the valid pairs of a replay: Tables 5-3 to 5-7 of
/// the thesis. The reference is the constant twist that produces the true motion in the same time step.
struct RateErrors {
  std::size_t pairs = 0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Vx, Vy, Vz, m/s
  double pitch = 0.0, yaw = 0.0, roll = 0.0;           ///< rad/s
};

/// Throws std::runtime_error if no pair has both an estimate and a true motion.
RateErrors rateErrors(const Replay& replay, const SequenceTruth& truth);

}  // namespace cartvo::benchmark
