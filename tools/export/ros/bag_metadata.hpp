#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cartvo {

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

/// The file metadata.yaml of a bag, which `ros2 bag` looks for. Version 5, that of ROS 2 Humble: later ones
/// read it, too.
std::string bagMetadataText(const BagMetadata& metadata);

}  // namespace cartvo
