#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "pipeline/protection_level.hpp"
#include "tools/trajectory/trajectory.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// A row of odometry.csv: a message as cartvod publishes it, see odometry_t. Covariances: order (x, y, z,
/// rotation about x, y, z), SI units, body axes.
struct OdometryRow {
  std::int64_t time_ns = 0;  ///< exposure of the left image, to 1 us
  bool valid = false;
  std::int32_t reasons = 0;
  std::int32_t reset_counter = 0;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  vo::Vector6d twist = vo::Vector6d::Zero();  ///< velocity (m/s) and rates (rad/s); NaN if not valid
  vo::Matrix6d pose_covariance = vo::Matrix6d::Zero(), twist_covariance = vo::Matrix6d::Zero();  ///< as above
  pipeline::ProtectionLevel bound;  ///< NaN if there is no estimate

  /// Whether the pose is an estimate: that of a VALID message, or of one that is too uncertain to be VALID.
  bool hasEstimate() const { return valid || bound.velocity.allFinite(); }
};

/// Reads the odometry.csv of a replay; its columns may be in any order. Throws std::runtime_error naming
/// file, line and what was expected.
std::vector<OdometryRow> readOdometryFile(const std::filesystem::path& file);

/// Whether a file begins as an odometry.csv does.
bool isOdometryFile(const std::filesystem::path& file);

/// Poses of the body at each message, relative to the first one's. After a loss of tracking the new epoch
/// continues from the last known pose, which messages without an estimate repeat. Omits messages that are not
/// later than the one before.
Trajectory bodyTrajectory(const std::vector<OdometryRow>& rows);

}  // namespace cartvo
