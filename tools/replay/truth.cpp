// Reads the true poses at the pairs of a replay.

#include "tools/replay/truth.hpp"

#include <stdexcept>
#include <string>

#include "tools/evaluate/association.hpp"
#include "tools/replay/kitti_oxts.hpp"

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

/// The poses of `truth` at the instants of `estimate`, which are those of the pairs, relative to the first.
Truth atInstants(const Trajectory& estimate, const Trajectory& truth, const Replay& replay) {
  const Trajectory known = associateByTime(estimate, truth).truth;
  Truth poses;
  auto next = known.begin();
  for (const ReplayedPair& pair : replay.pairs) {
    const bool is_known = next != known.end() && next->time_ns == pair.exposure_ns;
    poses.emplace_back();
    if (is_known) poses.back() = known.front().pose.inverse() * (next++)->pose;
  }
  return poses;
}

/// From poses of the left camera to those of the body.
Truth ofBody(Truth left_camera, const Eigen::Isometry3d& T_body_left) {
  for (std::optional<Eigen::Isometry3d>& pose : left_camera)
    if (pose) pose = T_body_left * *pose * T_body_left.inverse();
  return left_camera;
}

/// Calls `read`; its errors name the file.
template <typename Read>
Truth naming(const std::filesystem::path& file, const Read& read) {
  try {
    return read();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

}  // namespace

Trajectory readTruthRows(const std::filesystem::path& file) {
  return std::filesystem::is_directory(file) ? readKittiOxts(file) : readTrajectory(file);
}

Truth readTruth(const std::filesystem::path& file, const Replay& replay) {
  const Trajectory rows = readTruthRows(file);
  const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
  const Trajectory body = bodyTrajectory(replay);
  if (std::filesystem::is_directory(file))
    return naming(file, [&] { return ofBody(atInstants(body, rows, replay), T_body_left); });
  if (!isKittiTrajectory(file)) return naming(file, [&] { return atInstants(body, rows, replay); });
  if (rows.size() != replay.pairs.size()) {
    throw std::runtime_error(file.string() + ": has " + std::to_string(rows.size()) + " poses for " +
                             std::to_string(replay.pairs.size()) +
                             " pairs; KITTI rows have no times, so there must be one row for each pair");
  }
  return fromCameraRows(rows, T_body_left);
}

}  // namespace cartvo
