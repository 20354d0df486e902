// Judges the published messages of a replay.
#include "tools/benchmark/accuracy/judged_replay.hpp"

#include <algorithm>
#include <optional>

#include "tools/benchmark/accuracy/true_motion.hpp"
#include "tools/evaluate/validity/true_twist.hpp"
#include "tools/simulate/truth.hpp"

namespace cartvo::benchmark {
namespace {

Eigen::Vector3d vectorOf(const double (&values)[3]) {
  return Eigen::Map<const Eigen::Vector3d>(values);
}

/// The parts of a message that are judged, at the exact instant of its exposure.
OdometryRow rowOf(const ReplayedPair& pair) {
  const odometry_t& message = pair.message;
  OdometryRow row;
  row.time_ns = pair.exposure_ns;
  row.valid = message.status == odometry_t::VALID;
  row.reset_counter = message.reset_counter;
  const double* q = message.orientation_world_body;
  row.T_world_body.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  row.T_world_body.translation() = vectorOf(message.position_world_body);
  row.twist << vectorOf(message.velocity_body), vectorOf(message.angular_velocity_body);
  row.bound = {vectorOf(message.velocity_bound), vectorOf(message.angular_rate_bound),
               vectorOf(message.motion_bound), vectorOf(message.rotation_bound)};
  return row;
}

}  // namespace

std::vector<JudgedMessage> judge(const Replay& replay, const SequenceTruth& truth) {
  const Trajectory body = simulate::bodyTrajectory(truth.left_camera, replay.rig.rig);
  const TrueTwist twists(body);
  const TruthRows truth_rows(replay, truth.left_camera);
  std::vector<OdometryRow> rows;
  std::vector<TrueState> states;
  for (std::size_t i = 0; i < replay.pairs.size(); ++i) {
    rows.push_back(rowOf(replay.pairs[i]));
    TrueState& state = states.emplace_back();
    const std::optional<std::size_t> row = truth_rows.at(i);
    if (!row) continue;
    state.T_world_body = body[*row].pose;
    if (truth.has_jumps) continue;
    state.twist = truth.body_twist.empty() ? twists.at(rows.back().time_ns) : truth.body_twist[*row];
  }
  return judge(rows, states);
}

}  // namespace cartvo::benchmark
