#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace cartvo {

/// A pose and the instant it holds for (ns since the Unix epoch, or since the sequence's start).
struct StampedPose {
  std::int64_t time_ns = 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// Poses in the order of time, all of one frame in one world.
using Trajectory = std::vector<StampedPose>;

/// Reads either format, told apart by the numbers in a row: 8 is TUM (seconds x y z qx qy qz qw), 12 is KITTI
/// (the rows of a 3x4 matrix; `time_ns` is then the row's index). '#' begins a comment. Throws
/// std::runtime_error naming file, line and what was expected.
Trajectory readTrajectory(const std::filesystem::path& file);

/// Whether the file's rows are KITTI's (no instants).
bool isKittiTrajectory(const std::filesystem::path& file);

/// Seconds with nine decimals, then x y z qx qy qz qw.
void writeTum(const std::filesystem::path& file, const Trajectory& trajectory);

/// A 3x4 matrix a row; instants are not kept.
void writeKitti(const std::filesystem::path& file, const Trajectory& trajectory);

}  // namespace cartvo
