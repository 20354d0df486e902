#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "tools/export/export_source.hpp"

// The cart's motion in the conventions of ROS (REP-103, REP-105) and Foxglove.

namespace cartvo {

/// Frames: `odom` is the body at the first pair, `base_link` the body (x forward, y left, z up; the rig file
/// defines its origin), the cameras' have x right, y down, z forward.
inline constexpr const char* kOdometryFrame = "odom";
inline constexpr const char* kBodyFrame = "base_link";
inline constexpr const char* kLeftCameraFrame = "left_camera_optical";
inline constexpr const char* kRightCameraFrame = "right_camera_optical";

/// A 6x6 matrix, row by row, in the order x, y, z, rotation about x, y, z; SI units.
using CovarianceRows = std::array<double, 36>;

/// Motion of one pair.
struct ExportedMotion {
  std::int64_t exposure_ns = 0;   ///< instant of pose and velocity
  std::int64_t reception_ns = 0;  ///< receptionTime
  bool valid = false;             ///< else the pose is the last known one, and there is nothing else
  std::string reasons;            ///< why it is not valid
  /// body to odom; goes on from the last valid pose after a loss of tracking
  Eigen::Isometry3d T_odom_body = Eigen::Isometry3d::Identity();
  CovarianceRows pose_covariance{};                    ///< odom axes, since the last restart of the pose
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the body's origin, body axes, m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< body axes, rad/s
  CovarianceRows twist_covariance{};                           ///< body axes
};

/// Motions of all pairs of a replay; poses alone as motions that are valid and have no velocity and no
/// covariance. Throws std::runtime_error naming the source if instants lie before 1970.
std::vector<ExportedMotion> exportedMotions(const ExportSource& source);

/// A pose of a frame in its parent frame.
struct FramePose {
  const char* parent;
  const char* child;
  Eigen::Isometry3d T_parent_child;
};

/// The cameras on the body.
std::array<FramePose, 2> cameraFrames(const calib::Rig& rig);

}  // namespace cartvo
