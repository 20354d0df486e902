// Reads the true poses at the pairs of a replay.

#include "tools/replay/truth.hpp"

#include <stdexcept>
#include <string>

#include "tools/evaluate/association.hpp"

namespace cartvo {
namespace {

Truth fromCameraRows(const Trajectory& rows, const Eigen::Isometry3d& T_body_left) {
  const Eigen::Isometry3d T_first_world = rows.front().pose.inverse();
  Truth truth;
  for (const StampedPose& row : rows) {
    truth.emplace_back(T_body_left * T_first_world * row.pose * T_body_left.inverse());
  }
  return truth;
}

Truth fromBodyInstants(const Trajectory& body_truth, const Replay& replay) {
  Trajectory instants;
  for (const StampedPose& stamped : bodyTrajectory(replay))
    instants.push_back(stamped);
  const Trajectory known = associateByTime(instants, body_truth).truth;
  Truth truth;
  auto next = known.begin();
  for (const ReplayedPair& pair : replay.pairs) {
    const bool is_known = next != known.end() && next->time_ns == pair.exposure_ns;
    truth.emplace_back();
    if (is_known) truth.back() = known.front().pose.inverse() * (next++)->pose;
  }
  return truth;
}

}  // namespace

Truth readTruth(const std::filesystem::path& file, const Replay& replay) {
  const Trajectory rows = readTrajectory(file);
  if (!isKittiTrajectory(file)) {
    try {
      return fromBodyInstants(rows, replay);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(file.string() + ": " + error.what());
    }
  }
  if (rows.size() != replay.pairs.size()) {
    throw std::runtime_error(file.string() + ": has " + std::to_string(rows.size()) + " poses for " +
                             std::to_string(replay.pairs.size()) +
                             " pairs; KITTI rows have no times, so there must be one row for each pair");
  }
  return fromCameraRows(rows, replay.rig.rig.T_body_camera);
}

}  // namespace cartvo
