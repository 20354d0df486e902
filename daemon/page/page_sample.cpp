// Numbers of odometry messages for the status page.
#include "daemon/page/page_sample.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace cartvo::daemon {
namespace {

constexpr int kDigits = 6;          // of a measured number
constexpr int kIntegerDigits = 17;  // of times in us
constexpr std::size_t kFirstMeasured = 5;

Eigen::Quaterniond orientationOf(const odometry_t& message) {
  const double* q = message.orientation_world_body;
  return {q[0], q[1], q[2], q[3]};
}

/// Standard deviation of the element on the diagonal of a 6x6 covariance.
double stddev(const double (&covariance)[36], int element) {
  return std::sqrt(std::max(covariance[7 * element], 0.0));
}

}  // namespace

PageSample pageSample(const odometry_t& message, double process) {
  const Eigen::Matrix3d R = orientationOf(message).toRotationMatrix();
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> pose(message.pose_covariance_body);
  const Eigen::Matrix3d position = R * pose.topLeftCorner<3, 3>() * R.transpose();
  const bool has_times = message.arrival_utime != 0 && message.publication_utime != 0;
  const double latency_ms =
      has_times ? 1e-3 * static_cast<double>(message.publication_utime - message.arrival_utime) : NAN;
  const double* v = message.velocity_body;
  const double* w = message.angular_velocity_body;
  const auto& twist = message.twist_covariance_body;
  return {{static_cast<double>(message.sequence),
           static_cast<double>(message.utime),
           message.status == odometry_t::VALID ? 1.0 : 0.0,
           static_cast<double>(message.reasons),
           static_cast<double>(message.reset_counter),
           message.position_world_body[0],
           message.position_world_body[1],
           message.position_world_body[2],
           std::atan2(R(1, 0), R(0, 0)),
           position(0, 0),
           position(0, 1),
           position(1, 1),
           v[0],
           stddev(twist, 0),
           w[0],
           stddev(twist, 3),
           w[1],
           stddev(twist, 4),
           w[2],
           stddev(twist, 5),
           latency_ms,
           1e3 * process,
           1e-3 * static_cast<double>(message.offset_us),
           static_cast<double>(message.features),
           static_cast<double>(message.tracked),
           static_cast<double>(message.inliers),
           static_cast<double>(message.quality),
           message.velocity_bound[0],
           message.angular_rate_bound[0],
           message.angular_rate_bound[1],
           message.angular_rate_bound[2],
           *std::max_element(std::begin(message.motion_bound), std::end(message.motion_bound)),
           *std::max_element(std::begin(message.rotation_bound), std::end(message.rotation_bound))}};
}

void appendNumber(double value, int digits, std::string& json) {
  if (!std::isfinite(value)) {
    json += "null";
    return;
  }
  fmt::format_to(std::back_inserter(json), "{:.{}g}", value, digits);
}

void appendJson(const PageSample& sample, std::string& json) {
  json += '[';
  for (std::size_t i = 0; i < sample.values.size(); ++i) {
    if (i > 0) json += ',';
    appendNumber(sample.values[i], i < kFirstMeasured ? kIntegerDigits : kDigits, json);
  }
  json += ']';
}

}  // namespace cartvo::daemon
