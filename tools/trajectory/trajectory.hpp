#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace cartvo {

/// A pose and its time (ns since the Unix epoch, or since the start of the sequence).
struct StampedPose {
  std::int64_t time_ns = 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// Poses of one frame in one world, in the order of time.
using Trajectory = std::vector<StampedPose>;

/// The frame whose poses a file has.
enum class TrajectoryFrame : std::uint8_t {
  unknown,
  left_camera,       ///< x right, y down, z forward
  unmounted_camera,  ///< the left camera in the axes of a body that it looks forward from
  body,              ///< x forward, y left, z up
};

/// Such as "the left camera".
const char* frameName(TrajectoryFrame frame);

/// The frame that the file's first line states, if cartvo wrote it. Rows of KITTI are by definition poses of
/// the left camera, unless a first line states another frame.
TrajectoryFrame frameOf(const std::filesystem::path& file);

/// Reads a trajectory; blanks or commas separate the numbers of a row, and '#' begins a comment:
/// - TUM: 8 numbers, seconds x y z qx qy qz qw, or with qw first if a comment names the columns so
/// - KITTI: 12 numbers, a 3x4 matrix, row-major; `time_ns` is then the row's index
/// - EuRoC's ground truth: 17 numbers or 8 with commas, ns x y z qw qx qy qz, then velocity and biases, which
/// are
///   not used
/// Throws
/// std::runtime_error naming file, line and what was expected.
Trajectory readTrajectory(const std::filesystem::path& file);

/// True if the file is in KITTI format, which has no times.
bool isKittiTrajectory(const std::filesystem::path& file);

/// Length of the path, m; 0 for less than two poses.
double pathLength(const Trajectory& trajectory);

/// Writes TUM format: seconds with nine decimals, then x y z qx qy qz qw. The first line, a comment, states
/// the frame if it is known.
void writeTum(const std::filesystem::path& file, const Trajectory& trajectory,
              TrajectoryFrame frame = TrajectoryFrame::unknown);

/// Writes KITTI format: a 3x4 matrix per row, without times. KITTI's devkit reads no comments, so there is
/// none.
void writeKitti(const std::filesystem::path& file, const Trajectory& trajectory);

/// Writes EuRoC's format: ns x y z qw qx qy qz, separated by commas, without the velocity and the biases of
/// its ground truth. The first line, a comment, names the columns. readTrajectory reads it back if the
/// instants are those since the Unix epoch.
void writeEuroc(const std::filesystem::path& file, const Trajectory& trajectory);

}  // namespace cartvo
