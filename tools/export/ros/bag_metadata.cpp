// Writes the metadata of a bag of ROS 2.
#include "tools/export/ros/bag_metadata.hpp"

#include "common/strict_yaml.hpp"

namespace cartvo {
namespace {

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

}  // namespace

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

}  // namespace cartvo
