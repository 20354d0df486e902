// Reads the true poses at the pairs of a replay.

#include "tools/replay/truth.hpp"

#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "tools/replay/interpolated_truth.hpp"
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

std::string span(std::int64_t first_ns, std::int64_t last_ns) {
  return fmt::format("{:.3f} s to {:.3f} s", 1e-9 * static_cast<double>(first_ns),
                     1e-9 * static_cast<double>(last_ns));
}

/// The poses of `truth` at the instants of the pairs, relative to the first. Of pairs with decreasing
/// instants only those that are later than all before count.
Truth atInstants(const Trajectory& truth, const Replay& replay) {
  const InterpolatedTruth interpolated(truth);
  Truth poses;
  std::optional<std::int64_t> last_ns;
  std::optional<Eigen::Isometry3d> T_first_world;
  std::size_t known = 0;
  for (const ReplayedPair& pair : replay.pairs) {
    poses.emplace_back();
    if (last_ns && pair.exposure_ns <= *last_ns) continue;
    last_ns = pair.exposure_ns;
    poses.back() = interpolated.at(pair.exposure_ns);
    if (!poses.back()) continue;
    if (!T_first_world) T_first_world = poses.back()->inverse();
    poses.back() = *T_first_world * *poses.back();
    ++known;
  }
  if (known < 2) {
    throw std::runtime_error(
        "fewer than two pairs have a truth at their time: the pairs are of " +
        span(replay.pairs.front().exposure_ns, replay.pairs.back().exposure_ns) + ", the truth of " +
        span(truth.front().time_ns, truth.back().time_ns) +
        "; check that both are of one drive ('cartvo simulate' keeps the truth of an earlier run as "
        "truth-SECOND.tum) and one clock, in seconds; replay without --truth, then 'cartvo evaluate' of "
        "trajectory.tum says by how much the clocks differ");
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
  if (std::filesystem::is_directory(file))
    return naming(file, [&] { return ofBody(atInstants(rows, replay), T_body_left); });
  if (!isKittiTrajectory(file)) return naming(file, [&] { return atInstants(rows, replay); });
  if (rows.size() != replay.pairs.size()) {
    throw std::runtime_error(file.string() + ": has " + std::to_string(rows.size()) + " poses for " +
                             std::to_string(replay.pairs.size()) +
                             " pairs; KITTI rows have no times, so there must be one row for each pair");
  }
  return fromCameraRows(rows, T_body_left);
}

}  // namespace cartvo
