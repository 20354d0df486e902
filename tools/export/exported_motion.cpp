// Converts the odometry to the conventions of ROS and Foxglove.
#include "tools/export/exported_motion.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "daemon/publish/message_names.hpp"

namespace cartvo {
namespace {

using Matrix6Rows = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// The covariance of a pose's error in the axes of its parent, from that in the axes of the body.
CovarianceRows inParentAxes(const double (&body_rows)[36], const Eigen::Matrix3d& R_parent_body) {
  Matrix6Rows R = Matrix6Rows::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = R_parent_body;
  CovarianceRows rows{};
  Eigen::Map<Matrix6Rows>{rows.data()} = R * Eigen::Map<const Matrix6Rows>(body_rows) * R.transpose();
  return rows;
}

ExportedMotion exportedMotion(const ReplayedPair& pair, const Eigen::Isometry3d& T_body_left) {
  ExportedMotion motion;
  const odometry_t& message = pair.message;
  motion.exposure_ns = pair.exposure_ns;
  motion.reception_ns = receptionTime(pair);
  motion.valid = message.status == odometry_t::VALID;
  motion.T_odom_body = T_body_left * pair.T_first_left * T_body_left.inverse();
  if (!motion.valid) {
    motion.reasons = daemon::reasonNames(message.reasons);
    return motion;
  }
  motion.pose_covariance = inParentAxes(message.pose_covariance_body, motion.T_odom_body.linear());
  motion.velocity = Eigen::Map<const Eigen::Vector3d>(message.velocity_body);
  motion.angular_velocity = Eigen::Map<const Eigen::Vector3d>(message.angular_velocity_body);
  std::copy(std::begin(message.twist_covariance_body), std::end(message.twist_covariance_body),
            motion.twist_covariance.begin());
  return motion;
}

ExportedMotion exportedPose(const StampedPose& pose) {
  ExportedMotion motion;
  motion.exposure_ns = motion.reception_ns = pose.time_ns;
  motion.valid = true;
  motion.T_odom_body = pose.pose;
  return motion;
}

}  // namespace

std::vector<ExportedMotion> exportedMotions(const ExportSource& source) {
  std::vector<ExportedMotion> motions;
  if (source.replay) {
    for (const ReplayedPair& pair : source.replay->pairs)
      motions.push_back(exportedMotion(pair, source.replay->rig.rig.T_body_camera));
  } else {
    std::transform(source.poses.begin(), source.poses.end(), std::back_inserter(motions), exportedPose);
  }
  for (const ExportedMotion& motion : motions) {
    if (motion.exposure_ns < 0 || motion.reception_ns < 0)
      throw std::runtime_error(source.path.string() + ": has instants before 1970, which MCAP cannot hold");
  }
  return motions;
}

std::array<FramePose, 2> cameraFrames(const calib::Rig& rig) {
  return {{{kBodyFrame, kLeftCameraFrame, rig.T_body_camera},
           {kLeftCameraFrame, kRightCameraFrame, rig.T_right_left.inverse()}}};
}

}  // namespace cartvo
