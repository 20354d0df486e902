// Builds Foxglove's messages.
#include "tools/export/mcap/foxglove_messages.hpp"

#include "tools/export/mcap/protobuf_message.hpp"

namespace cartvo {
namespace {

ProtobufMessage timestamp(std::int64_t time_ns) {
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  return ProtobufMessage()
      .number(1, static_cast<std::uint64_t>(time_ns / kNanosecondsPerSecond))
      .number(2, static_cast<std::uint64_t>(time_ns % kNanosecondsPerSecond));
}

ProtobufMessage vector(const Eigen::Vector3d& v) {
  return ProtobufMessage().real(1, v.x()).real(2, v.y()).real(3, v.z());
}

ProtobufMessage quaternion(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return ProtobufMessage().real(1, q.x()).real(2, q.y()).real(3, q.z()).real(4, q.w());
}

ProtobufMessage poseMessage(const Eigen::Isometry3d& pose) {
  return ProtobufMessage().message(1, vector(pose.translation())).message(2, quaternion(pose));
}

}  // namespace

std::string foxgloveOdometry(const ExportedMotion& motion) {
  return ProtobufMessage()
      .message(1, timestamp(motion.exposure_ns))
      .text(2, kOdometryFrame)
      .text(3, kBodyFrame)
      .message(4, poseMessage(motion.T_odom_body))
      .message(5, vector(motion.velocity))
      .message(6, vector(motion.angular_velocity))
      .reals(7, motion.pose_covariance)
      .reals(8, motion.twist_covariance)
      .bytes();
}

std::string foxglovePose(const ExportedMotion& motion) {
  return ProtobufMessage()
      .message(1, timestamp(motion.exposure_ns))
      .text(2, kOdometryFrame)
      .message(3, poseMessage(motion.T_odom_body))
      .bytes();
}

std::string foxgloveTransform(std::int64_t time_ns, const FramePose& frame) {
  return ProtobufMessage()
      .message(1, timestamp(time_ns))
      .text(2, frame.parent)
      .text(3, frame.child)
      .message(4, vector(frame.T_parent_child.translation()))
      .message(5, quaternion(frame.T_parent_child))
      .bytes();
}

std::string foxgloveVideo(std::int64_t time_ns, const char* frame, std::span<const std::uint8_t> picture,
                          const char* codec) {
  return ProtobufMessage()
      .message(1, timestamp(time_ns))
      .text(2, frame)
      .text(3, {reinterpret_cast<const char*>(picture.data()), picture.size()})
      .text(4, codec)
      .bytes();
}

std::string foxgloveLog(std::int64_t time_ns, bool is_warning, const std::string& text) {
  constexpr std::uint64_t kInformation = 2, kWarning = 3;
  return ProtobufMessage()
      .message(1, timestamp(time_ns))
      .number(2, is_warning ? kWarning : kInformation)
      .text(3, text)
      .text(4, "cartvo")
      .bytes();
}

}  // namespace cartvo
