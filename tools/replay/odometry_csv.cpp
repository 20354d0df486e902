// Writes the published messages of a replay as CSV, with covariances.
#include "tools/replay/odometry_csv.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace cartvo {
namespace {

constexpr std::size_t kSide = 6;
constexpr std::array<const char*, kSide> kPoseAxes{"x", "y", "z", "rx", "ry", "rz"};
constexpr std::array<const char*, kSide> kTwistAxes{"vx", "vy", "vz", "wx", "wy", "wz"};
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

template <std::size_t side>
void addNames(std::string& row, const char* matrix, const std::array<const char*, side>& axes) {
  for (std::size_t i = 0; i < side; ++i) {
    for (std::size_t j = i; j < side; ++j)
      row.append(",").append(matrix).append("_").append(axes[i]).append("_").append(axes[j]);
  }
}

void add(std::string& row, double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), ",%.9g", value + 0.0);  // no "-0"
  row += std::isfinite(value) ? text.data() : ",";
}

template <std::size_t count>
void add(std::string& row, const double (&values)[count]) {
  for (const double value : values)
    add(row, value);
}

template <std::size_t side, std::size_t count>
void addTriangle(std::string& row, const double (&matrix)[count]) {
  static_assert(count == side * side);
  for (std::size_t i = 0; i < side; ++i) {
    for (std::size_t j = i; j < side; ++j)
      add(row, matrix[side * i + j]);
  }
}

std::string header() {
  std::string row =
      "pair,utime_us,valid,reasons,reset_counter,offset_us,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_"
      "rad_s,"
      "wy_rad_s,wz_rad_s";
  addNames(row, "pose_covariance", kPoseAxes);
  addNames(row, "twist_covariance", kTwistAxes);
  row += ",features,tracked,inliers";
  for (const char* bound : {"velocity", "angular_rate", "motion", "rotation"}) {
    for (const char* axis : kAxes)
      row.append(",").append(bound).append("_bound_").append(axis);
  }
  row += ",quality,ax_m_s2,ay_m_s2,az_m_s2";
  addNames(row, "acceleration_covariance", kAxes);
  return row + "\n";
}

}  // namespace

std::string odometryCsv(const Replay& replay) {
  std::string csv = header();
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const odometry_t& message = replay.pairs[index].message;
    std::string row = std::to_string(index) + "," + std::to_string(message.utime) + "," +
                      std::to_string(message.status) + "," + std::to_string(message.reasons) + "," +
                      std::to_string(message.reset_counter) + "," + std::to_string(message.offset_us);
    add(row, message.position_world_body);
    add(row, message.orientation_world_body);
    add(row, message.velocity_body);
    add(row, message.angular_velocity_body);
    addTriangle<kSide>(row, message.pose_covariance_body);
    addTriangle<kSide>(row, message.twist_covariance_body);
    for (const std::int32_t count : {message.features, message.tracked, message.inliers})
      row.append(",").append(std::to_string(count));
    for (const auto* bound : {&message.velocity_bound, &message.angular_rate_bound, &message.motion_bound,
                              &message.rotation_bound})
      add(row, *bound);
    row.append(",").append(std::to_string(message.quality));
    add(row, message.acceleration_body);
    addTriangle<kAxes.size()>(row, message.acceleration_covariance_body);
    csv += row + "\n";
  }
  return csv;
}

}  // namespace cartvo
