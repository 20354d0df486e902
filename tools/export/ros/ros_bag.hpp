#pragma once

#include <filesystem>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Writes a bag of ROS 2 (one MCAP file, as rosbag2_storage_mcap reads it): /odometry (nav_msgs/msg/Odometry)
/// and /tf (odom to base_link, and the cameras) of each valid pair. Invalid pairs are left out, because
/// filters take NaN and zero for measurements. The time of a message is when it could be received
/// (receptionTime), its stamp the exposure. The file appears when it is complete. Throws std::runtime_error
/// naming the file and the reason.
void writeRosBag(const std::filesystem::path& file, const Replay& replay);

}  // namespace cartvo
