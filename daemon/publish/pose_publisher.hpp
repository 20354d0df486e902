#pragma once

#include <cstdint>
#include <string>

#include <bot_core/pose_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "daemon/publish/message_sender.hpp"

// Poses for programs that know the type bot_core.pose_t of libbot.

namespace cartvo::daemon {

/// Axes of the velocity in bot_core.pose_t: programs that use the type differ, and it has no field for it.
enum class PoseVelocity : std::uint8_t { local, body };

/// The pose of a VALID message. The acceleration, which is not measured, is NaN.
bot_core::pose_t poseMessage(const odometry_t& message, PoseVelocity velocity);

/// Publishes the pose of each VALID odometry message. The type cannot say that a pose is invalid; therefore
/// nothing is sent for others.
class PosePublisher {
 public:
  /// `sender` is borrowed and must outlive the publisher. `channel` empty: never publishes.
  PosePublisher(MessageSender& sender, std::string channel, PoseVelocity velocity);

  /// For the messages from now on.
  void setChannel(const std::string& channel, PoseVelocity velocity);

  void publish(const odometry_t& message);

 private:
  MessageSender& sender_;
  std::string channel_;
  PoseVelocity velocity_;
};

}  // namespace cartvo::daemon
