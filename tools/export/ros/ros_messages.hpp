#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tools/export/exported_motion.hpp"

// Messages of ROS 2 and their definitions. A message is serialised as CDR, little endian, as in rosbag2.

namespace cartvo {

/// A message type: its name, such as "nav_msgs/msg/Odometry", and its definition with those that it uses, as
/// MCAP's schema encoding "ros2msg" expects them.
struct RosType {
  const char* name;
  std::string definition;
};

RosType rosOdometryType();
RosType rosTransformsType();
RosType rosVideoType();

/// nav_msgs/msg/Odometry: pose and its covariance in the axes of `odom`, twist and its covariance in those of
/// `base_link`; the stamp is the exposure.
std::string rosOdometry(const ExportedMotion& motion);

/// tf2_msgs/msg/TFMessage with one transform for each frame.
std::string rosTransforms(std::int64_t time_ns, std::span<const FramePose> frames);

/// foxglove_msgs/msg/CompressedVideo with one picture; see PictureMessage.
std::string rosVideo(std::int64_t time_ns, const char* frame, std::span<const std::uint8_t> picture,
                     const char* codec);

}  // namespace cartvo
