// Writes the odometry of a replay as a bag of ROS 2.
#include "tools/export/ros/ros_bag.hpp"

#include <array>
#include <string>

#include "tools/export/exported_motion.hpp"
#include "tools/export/mcap/mcap_writer.hpp"
#include "tools/export/ros/ros_messages.hpp"

namespace cartvo {
namespace {

std::uint16_t addChannel(McapWriter& writer, const char* topic, const RosType& type) {
  return writer.addChannel(writer.addSchema(type.name, "ros2msg", type.definition), topic, "cdr");
}

}  // namespace

void writeRosBag(const std::filesystem::path& file, const Replay& replay) {
  AtomicFileWriter output(file);
  McapWriter writer(output, "ros2");
  const std::uint16_t odometry = addChannel(writer, "/odometry", rosOdometryType());
  const std::uint16_t transforms = addChannel(writer, "/tf", rosTransformsType());
  const auto [left, right] = cameraFrames(replay.rig.rig);
  for (const ExportedMotion& motion : exportedMotions(replay)) {
    if (!motion.valid) continue;
    const auto time = static_cast<std::uint64_t>(motion.reception_ns);
    writer.write(odometry, time, time, rosOdometry(motion));
    const std::array<FramePose, 3> frames{{{kOdometryFrame, kBodyFrame, motion.T_odom_body}, left, right}};
    writer.write(transforms, time, time, rosTransforms(motion.exposure_ns, frames));
  }
  writer.finish();
  output.commit();
}

}  // namespace cartvo
