// Serialises messages of ROS 2.
#include "tools/export/ros/ros_messages.hpp"

#include <utility>
#include <vector>

#include "tools/export/mcap/little_endian.hpp"

namespace cartvo {
namespace {

/// Definitions of the types that the messages use.
constexpr std::pair<const char*, const char*> kHeader{"std_msgs/Header",
                                                      "builtin_interfaces/Time stamp\nstring frame_id\n"};
constexpr std::pair<const char*, const char*> kTime{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"};
constexpr std::pair<const char*, const char*> kVector{"geometry_msgs/Vector3",
                                                      "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr std::pair<const char*, const char*> kPoint{"geometry_msgs/Point",
                                                     "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr std::pair<const char*, const char*> kQuaternion{
    "geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"};
constexpr std::pair<const char*, const char*> kPose{
    "geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"};
constexpr std::pair<const char*, const char*> kPoseWithCovariance{
    "geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"};
constexpr std::pair<const char*, const char*> kTwist{
    "geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"};
constexpr std::pair<const char*, const char*> kTwistWithCovariance{
    "geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"};
constexpr std::pair<const char*, const char*> kTransform{
    "geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"};
constexpr std::pair<const char*, const char*> kTransformStamped{
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"};

std::string definition(std::string own, const std::vector<std::pair<const char*, const char*>>& used) {
  for (const auto& [name, text] : used)
    own.append(80, '=').append("\nMSG: ").append(name).append("\n").append(text);
  return own;
}

/// Writes CDR (OMG DDS-XTypes 7.4.1): each number at a multiple of its size from the end of the header.
class CdrWriter {
 public:
  template <typename Number>
  void number(Number value) {
    while ((bytes_.size() - kHeaderBytes) % sizeof value != 0)
      bytes_ += '\0';
    appendLittleEndian(bytes_, value);
  }

  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value).append(1, '\0');
  }

  void bytes(std::span<const std::uint8_t> values) {
    number(static_cast<std::uint32_t>(values.size()));
    bytes_.append(values.begin(), values.end());
  }

  /// std_msgs/msg/Header.
  void header(std::int64_t time_ns, const char* frame) {
    constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
    number(static_cast<std::uint32_t>(time_ns / kNanosecondsPerSecond));
    number(static_cast<std::uint32_t>(time_ns % kNanosecondsPerSecond));
    text(frame);
  }

  void vector(const Eigen::Vector3d& v) {
    for (const double value : v)
      number(value);
  }

  void pose(const Eigen::Isometry3d& pose) {
    vector(pose.translation());
    const Eigen::Quaterniond q(pose.linear());
    for (const double value : q.coeffs())  // x y z w
      number(value);
  }

  void covariance(const CovarianceRows& rows) {
    for (const double value : rows)
      number(value);
  }

  const std::string& message() const { return bytes_; }

 private:
  static constexpr std::size_t kHeaderBytes = 4;
  std::string bytes_{'\0', '\1', '\0', '\0'};  ///< CDR_LE, no options
};

}  // namespace

RosType rosOdometryType() {
  return {"nav_msgs/msg/Odometry",
          definition("std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
                     "geometry_msgs/TwistWithCovariance twist\n",
                     {kHeader, kTime, kPoseWithCovariance, kPose, kPoint, kQuaternion, kTwistWithCovariance,
                      kTwist, kVector})};
}

RosType rosTransformsType() {
  return {"tf2_msgs/msg/TFMessage",
          definition("geometry_msgs/TransformStamped[] transforms\n",
                     {kTransformStamped, kHeader, kTime, kTransform, kVector, kQuaternion})};
}

RosType rosVideoType() {
  return {"foxglove_msgs/msg/CompressedVideo",
          definition("builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n",
                     {kTime})};
}

std::string rosOdometry(const ExportedMotion& motion) {
  CdrWriter cdr;
  cdr.header(motion.exposure_ns, kOdometryFrame);
  cdr.text(kBodyFrame);
  cdr.pose(motion.T_odom_body);
  cdr.covariance(motion.pose_covariance);
  cdr.vector(motion.velocity);
  cdr.vector(motion.angular_velocity);
  cdr.covariance(motion.twist_covariance);
  return cdr.message();
}

std::string rosTransforms(std::int64_t time_ns, std::span<const FramePose> frames) {
  CdrWriter cdr;
  cdr.number(static_cast<std::uint32_t>(frames.size()));
  for (const FramePose& frame : frames) {
    cdr.header(time_ns, frame.parent);
    cdr.text(frame.child);
    cdr.pose(frame.T_parent_child);
  }
  return cdr.message();
}

std::string rosVideo(std::int64_t time_ns, const char* frame, std::span<const std::uint8_t> picture,
                     const char* codec) {
  CdrWriter cdr;
  cdr.header(time_ns, frame);  // the message begins with the members of a header
  cdr.bytes(picture);
  cdr.text(codec);
  return cdr.message();
}

}  // namespace cartvo
