// Writes the motion of each replayed pair as CSV.

#include "tools/replay/motion_csv.hpp"

#include <cmath>
#include <cstdio>

namespace cartvo {
namespace {

constexpr const char* kMotionColumns = "Vx,Vy,Vz,pitch_rate,yaw_rate,roll_rate";

using Row = std::string;

void add(Row& row, double value) {
  char text[40];
  std::snprintf(text, sizeof text, ",%.9g", value + 0.0);  // no "-0"
  row += std::isfinite(value) ? text : ",";
}

void add(Row& row, const vo::Vector6d& motion) {
  for (const double value : motion)
    add(row, value);
}

void addEmpty(Row& row, int columns) {
  row.append(static_cast<std::size_t>(columns), ',');
}

/// Velocities and rates in the order of the columns.
vo::Vector6d motionColumns(const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular_velocity) {
  vo::Vector6d columns;
  columns << velocity, angular_velocity.y(), angular_velocity.z(), angular_velocity.x();
  return columns;
}

void addPose(Row& row, const Eigen::Isometry3d& T_first_body) {
  const Eigen::Matrix3d R = T_first_body.linear();
  const Eigen::Vector3d position = T_first_body.translation();
  for (const double coordinate : position)
    add(row, coordinate);
  add(row, std::atan2(R(2, 1), R(2, 2)));
  add(row, std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))));
  add(row, std::atan2(R(1, 0), R(0, 0)));
}

}  // namespace

std::string motionCsv(const Replay& replay, const std::vector<std::string>& errors) {
  std::string csv = std::string("pair,time,valid,") + kMotionColumns +
                    ",x,y,z,roll,pitch,yaw,offset_ms,features,tracked,matched,inliers";
  if (!errors.empty()) {
    csv += ",error_Vx,error_Vy,error_Vz,error_pitch_rate,error_yaw_rate,error_roll_rate,error_position";
  }
  csv += '\n';
  const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const ReplayedPair& pair = replay.pairs[index];
    const Eigen::Isometry3d T_first_body = T_body_left * pair.T_first_left * T_body_left.inverse();
    char head[64];
    std::snprintf(head, sizeof head, "%zu,%lld.%09lld,%d", index,
                  static_cast<long long>(pair.exposure_ns / 1'000'000'000),
                  static_cast<long long>(pair.exposure_ns % 1'000'000'000), pair.valid ? 1 : 0);
    Row row = head;
    if (pair.valid) {
      add(row, motionColumns(pair.velocity, pair.angular_velocity));
    } else {
      addEmpty(row, 6);
    }
    addPose(row, T_first_body);
    add(row, 1e-6 * static_cast<double>(pair.offset_ns));
    for (const int count :
         {pair.counts.detected, pair.counts.tracked, pair.counts.matched, pair.counts.inliers}) {
      row += ',';
      row += std::to_string(count);
    }
    csv += row + (errors.empty() ? "" : errors[index]) + '\n';
  }
  return csv;
}

}  // namespace cartvo
