// RMSE of velocity and angular rates against the true motion.
#include "tools/benchmark/thesis/rate_errors.hpp"

#include <cmath>
#include <stdexcept>

#include "pipeline/body_motion.hpp"
#include "tools/benchmark/accuracy/true_motion.hpp"

namespace cartvo::benchmark {

RateErrors rateErrors(const Replay& replay, const SequenceTruth& truth) {
  const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
  const TruthRows rows(replay, truth.left_camera);
  vo::Vector6d squares = vo::Vector6d::Zero();
  RateErrors errors;
  for (std::size_t index = 1; index < replay.pairs.size(); ++index) {
    const ReplayedPair& pair = replay.pairs[index];
    if (!pair.valid) continue;
    const auto from = rows.at(referenceOf(replay, index)), to = rows.at(index);
    if (!from || !to) continue;
    const Eigen::Isometry3d motion = truth.left_camera[*from].pose.inverse() * truth.left_camera[*to].pose;
    vo::Vector6d error;
    error << pair.velocity, pair.angular_velocity;
    error -= pipeline::logarithm(T_body_left * motion * T_body_left.inverse()) / pair.time_step;
    squares += error.cwiseAbs2();
    ++errors.pairs;
  }
  if (errors.pairs == 0)
    throw std::runtime_error(
        "no pair has both an estimate and a true motion; check that poses.txt belongs to this sequence");
  const vo::Vector6d rmse = (squares / static_cast<double>(errors.pairs)).cwiseSqrt();
  errors.velocity = rmse.head<3>();
  errors.roll = rmse[3];
  errors.pitch = rmse[4];
  errors.yaw = rmse[5];
  return errors;
}

}  // namespace cartvo::benchmark
