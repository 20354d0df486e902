// Builds and publishes bot_core.pose_t.

#include "daemon/publish/pose_publisher.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace cartvo::daemon {

bot_core::pose_t poseMessage(const odometry_t& message, PoseVelocity velocity) {
  bot_core::pose_t pose{};
  pose.utime = message.utime;
  std::copy(std::begin(message.position_world_body), std::end(message.position_world_body), pose.pos);
  std::copy(std::begin(message.orientation_world_body), std::end(message.orientation_world_body),
            pose.orientation);
  std::copy(std::begin(message.angular_velocity_body), std::end(message.angular_velocity_body),
            pose.rotation_rate);
  Eigen::Vector3d axes_velocity(message.velocity_body);
  if (velocity == PoseVelocity::local) {
    const double* q = message.orientation_world_body;
    axes_velocity = Eigen::Quaterniond(q[0], q[1], q[2], q[3]) * axes_velocity;
  }
  Eigen::Map<Eigen::Vector3d>(pose.vel) = axes_velocity;
  std::fill(std::begin(pose.accel), std::end(pose.accel), std::numeric_limits<double>::quiet_NaN());
  return pose;
}

PosePublisher::PosePublisher(MessageSender& sender, std::string channel, PoseVelocity velocity)
    : sender_(sender), channel_(std::move(channel)), velocity_(velocity) {}

void PosePublisher::setChannel(const std::string& channel, PoseVelocity velocity) {
  channel_ = channel;
  velocity_ = velocity;
}

void PosePublisher::publish(const odometry_t& message) {
  if (channel_.empty() || message.status != odometry_t::VALID) return;
  const bot_core::pose_t pose = poseMessage(message, velocity_);
  sender_.publish(channel_, pose);
}

}  // namespace cartvo::daemon
