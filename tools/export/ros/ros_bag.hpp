#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>

#include "tools/export/export_source.hpp"

namespace cartvo {

/// Writes a bag of ROS 2: a folder with one MCAP file, as rosbag2_storage_mcap reads it, and metadata.yaml.
/// - /odometry (nav_msgs/msg/Odometry) and /tf (odom to base_link, and the cameras): each valid pair.
///   Invalid pairs are left out, because filters take NaN and zero for measurements.
/// - /left/video, /right/video (foxglove_msgs/msg/CompressedVideo): the pictures of a recording, as sent
///
/// The time of a message is when it could be received (receptionTime; the arrival of a picture), its stamp
/// the exposure. The files appear when they are complete; those of an existing bag in the folder are
/// replaced. `source` must have a replay. `progress` gets the
/// number of pictures written so far. Throws std::runtime_error naming the file and the reason.
void writeRosBag(const std::filesystem::path& folder, const ExportSource& source,
                 const std::function<void(std::size_t pictures)>& progress);

/// The files of a bag in the folder NAME: NAME_0.mcap, as ros2 bag record names it, and metadata.yaml.
std::array<std::filesystem::path, 2> rosBagFiles(const std::filesystem::path& folder);

}  // namespace cartvo
