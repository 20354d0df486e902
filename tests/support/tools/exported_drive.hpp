#pragma once

#include <cstdint>
#include <string>

#include "calib/model/rig.hpp"
#include "support/calib/rigs.hpp"
#include "tools/export/export_source.hpp"

namespace cartvo::test {

inline constexpr std::int64_t kDriveStart_ns = 1'700'000'000'123'456'789;
inline constexpr int kDrivePairs = 5;

/// A pair at 10 Hz. The cart drives forward 0.2 m a pair and has turned left by 90 degrees at once; its left
/// camera is 1.5 m above the body's origin. Each message differs; the first is INVALID.
inline ReplayedPair drivenPair(int index, const calib::Rig& rig) {
  ReplayedPair pair;
  pair.exposure_ns = kDriveStart_ns + index * 100'000'000;
  odometry_t& message = pair.message;
  message = {};
  message.utime = pair.exposure_ns / 1000;
  message.arrival_utime = message.utime + 40'000;
  message.status = index == 0 ? odometry_t::INVALID : odometry_t::VALID;
  message.reasons = index == 0 ? odometry_t::REASON_FIRST_PAIR : 0;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  if (index > 0)
    T_world_body.linear() = Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T_world_body.translation().y() = 0.2 * index;
  pair.T_first_left = rig.T_body_camera.inverse() * T_world_body * rig.T_body_camera;
  pair.valid = index > 0;
  message.velocity_body[0] = 2.0;
  message.angular_velocity_body[2] = 0.1 * index;
  message.pose_covariance_body[0] = 0.04;  // x of the body, y of the world
  message.pose_covariance_body[7] = 0.01;
  message.twist_covariance_body[0] = 0.25;
  return pair;
}

inline ExportSource drivenSource() {
  ExportSource source;
  source.path = "drive";
  source.replay.emplace();
  source.replay->rig.rig = rectifiedRig();
  source.replay->rig.rig.T_body_camera.translation().z() = 1.5;
  for (int i = 0; i < kDrivePairs; ++i)
    source.replay->pairs.push_back(drivenPair(i, source.replay->rig.rig));
  source.poses = bodyTrajectory(*source.replay);
  source.frame = TrajectoryFrame::body;
  return source;
}

}  // namespace cartvo::test
