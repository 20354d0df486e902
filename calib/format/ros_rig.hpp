#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// Reads the two camera_info files (YAML) of a stereo pair in ROS. Distortion: plumb_bob, rational_polynomial
/// or equidistant (the wide lens). The relative pose follows from the rectification: R of each camera takes
/// its axes to the rectified ones, and the right P contains -f * baseline. T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line, key and what was expected.
Rig readRosRig(const std::filesystem::path& left_file, const std::filesystem::path& right_file);

/// The texts of the two cameras' files.
struct RosText {
  std::string left, right;
};

/// The camera_info files of a rig, with cartvo's rectification and without the mount. Throws
/// std::invalid_argument if the rig cannot be rectified.
RosText rosText(const Rig& rig);

}  // namespace cartvo::calib
