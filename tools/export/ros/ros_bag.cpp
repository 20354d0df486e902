// Writes the odometry and the video of a replay as a bag of ROS 2.
#include "tools/export/ros/ros_bag.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/atomic_file.hpp"
#include "common/strict_yaml.hpp"
#include "tools/export/exported_motion.hpp"
#include "tools/export/mcap/mcap_writer.hpp"
#include "tools/export/mcap/picture_channels.hpp"
#include "tools/export/ros/ros_messages.hpp"

namespace cartvo {
namespace {

// Writes the metadata of a bag of ROS 2.

/// A topic of a bag of ROS 2.
struct BagTopic {
  std::string name;
  std::string type;  ///< such as "nav_msgs/msg/Odometry"
  std::uint64_t messages = 0;
};

/// Content of a bag with one MCAP file.
struct BagMetadata {
  std::string file;                   ///< without a folder
  std::uint64_t first = 0, last = 0;  ///< times of the messages, ns since the Unix epoch; 0 without messages
  std::vector<BagTopic> topics;
};

/// The lines of time and count, each after `indent`.
std::string span(const BagMetadata& metadata, std::uint64_t messages, const std::string& indent) {
  return indent + "duration:\n" + indent +
         "  nanoseconds: " + std::to_string(metadata.last - metadata.first) + "\n" + indent +
         "starting_time:\n" + indent + "  nanoseconds_since_epoch: " + std::to_string(metadata.first) + "\n" +
         indent + "message_count: " + std::to_string(messages) + "\n";
}

std::string topicText(const BagTopic& topic) {
  return "    - topic_metadata:\n        name: " + topic.name + "\n        type: " + topic.type +
         "\n        serialization_format: cdr\n        offered_qos_profiles: \"\"\n      message_count: " +
         std::to_string(topic.messages) + "\n";
}

/// The file metadata.yaml of a bag, which `ros2 bag` looks for. Version 5, that of ROS 2 Humble: later ones
/// read it, too.
std::string bagMetadataText(const BagMetadata& metadata) {
  std::uint64_t messages = 0;
  std::string topics;
  for (const BagTopic& topic : metadata.topics) {
    messages += topic.messages;
    topics += topicText(topic);
  }
  const std::string file = quotedYaml(metadata.file);
  return "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n" +
         span(metadata, messages, "  ") + "  topics_with_message_count:\n" + topics +
         "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - " + file +
         "\n  files:\n    - path: " + file + "\n" + span(metadata, messages, "      ");
}

/// Adds topics, and the definition of each type once.
class Topics {
 public:
  explicit Topics(McapWriter& writer) : writer_(writer) {}

  std::uint16_t add(const char* topic, const RosType& type) {
    if (!schemas_.contains(type.name))
      schemas_[type.name] = writer_.addSchema(type.name, "ros2msg", type.definition);
    const std::uint16_t channel = writer_.addChannel(schemas_[type.name], topic, "cdr");
    added_.push_back({topic, type.name, channel});
    return channel;
  }

  std::vector<BagTopic> counted() const {
    std::vector<BagTopic> topics;
    for (const auto& [topic, type, channel] : added_)
      topics.push_back({topic, type, writer_.messageCount(channel)});
    return topics;
  }

 private:
  struct Added {
    const char* topic;
    std::string type;
    std::uint16_t channel;
  };

  McapWriter& writer_;
  std::map<std::string, std::uint16_t> schemas_;
  std::vector<Added> added_;
};

std::vector<BagTopic> writeMessages(McapWriter& writer, const ExportSource& source,
                                    const std::vector<ExportedMotion>& motions,
                                    const std::function<void(std::size_t pictures)>& progress) {
  Topics topics(writer);
  const std::uint16_t odometry = topics.add("/odometry", rosOdometryType());
  const std::uint16_t transforms = topics.add("/tf", rosTransformsType());
  PictureChannels pictures(
      writer, source, [&](const char* topic) { return topics.add(topic, rosVideoType()); }, rosVideo);
  const auto [left, right] = cameraFrames(source.replay->rig.rig);
  for (const ExportedMotion& motion : motions) {
    pictures.writeUntil(motion.reception_ns);
    if (source.has_video) progress(pictures.writtenCount());
    if (!motion.valid) continue;
    const auto time = static_cast<std::uint64_t>(motion.reception_ns);
    writer.write(odometry, time, time, rosOdometry(motion));
    const std::array<FramePose, 3> frames{{{kOdometryFrame, kBodyFrame, motion.T_odom_body}, left, right}};
    writer.write(transforms, time, time, rosTransforms(motion.exposure_ns, frames));
  }
  pictures.writeUntil(std::numeric_limits<std::int64_t>::max());
  writer.finish();
  return topics.counted();
}

/// NAME of the folder NAME or NAME/, also of ".".
std::string nameOf(const std::filesystem::path& folder) {
  const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

}  // namespace

std::array<std::filesystem::path, 2> rosBagFiles(const std::filesystem::path& folder) {
  return {folder / (nameOf(folder) + "_0.mcap"), folder / "metadata.yaml"};
}

void writeRosBag(const std::filesystem::path& folder, const ExportSource& source,
                 const std::function<void(std::size_t pictures)>& progress) {
  const std::vector<ExportedMotion> motions = exportedMotions(source);
  const auto [file, metadata_file] = rosBagFiles(folder);
  AtomicFileWriter output(file);
  McapWriter writer(output, "ros2");
  const std::vector<BagTopic> topics = writeMessages(writer, source, motions, progress);
  const BagMetadata metadata{file.filename().string(), writer.firstTime(), writer.lastTime(), topics};
  output.commit();
  writeResultFile(metadata_file, bagMetadataText(metadata));
}

}  // namespace cartvo
