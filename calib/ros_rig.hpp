#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"

namespace cartvo {

/// The two files that ROS' camera_calibration and stereo drivers keep of a pair (camera_info as YAML):
/// distortion plumb_bob, rational_polynomial, or equidistant (the wide lens). How the cameras stand to each
/// other is in their rectification: R of each takes its axes to the rectified ones, and the right P holds
/// -f b. Throws std::runtime_error naming file, line, key and what was expected; T_body_camera is
/// forwardLookingMount().
Rig readRosRig(const std::filesystem::path& left_file, const std::filesystem::path& right_file);

/// The files of a rig's cameras.
struct RosText {
  std::string left, right;
};

/// Such files of a rig, rectified as cartvo does it, without its mount. Throws std::invalid_argument if the
/// rig cannot be rectified.
RosText rosText(const Rig& rig);

}  // namespace cartvo
